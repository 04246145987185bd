/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#ifndef RSAPIEN_INLINE_H
#define RSAPIEN_INLINE_H

/* A routine of one file that is put in place where it is called. Of one that is static sdcc keeps
 * a copy beside, which nobody calls; of one that is inline alone it keeps none. */
#ifdef __SDCC
#define INLINE inline
#else
#define INLINE static inline
#endif

#endif
