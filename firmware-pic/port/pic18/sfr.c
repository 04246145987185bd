/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* The one definition of each special function register of sfr.h. */
#include "sfr.h"

#ifdef __SDCC
#define SFR_DEFINE(name, address) __sfr __at(address) name;
#else
#define SFR_DEFINE(name, address) volatile unsigned char name;
#endif
SFR_LIST(SFR_DEFINE, SFR_NOTHING_OF_BIT)
