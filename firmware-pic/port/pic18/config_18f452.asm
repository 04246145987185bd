; SPDX-License-Identifier: MIT OR Apache-2.0
; Configuration words of the motion controller, PIC18F452. CLOCK_MHZ comes from the Makefile.
;
; As bytes from the even address 0x300000 on, and with every unimplemented bit 0: gpsim misreads a
; record that begins at 0x300001, and takes bit 6 of CONFIG4L for the extended instruction set on
; every PIC18. check_config.py compares the bytes of the image with the meaning that is wanted.
;
; Oscillator: 10 MHz crystal and PLL for 40 MHz; crystals of 20, 10 and 4 MHz as they are.
; Watchdog: on, 18 ms * 8 = 144 ms. Brown-out: below 4.2 V, which is what the chip needs.
; Nothing is protected against reading or writing.

        include "p18f452.inc"

        if CLOCK_MHZ == 40
OSCILLATOR equ _HSPLL_OSC_1H
        else
        if CLOCK_MHZ == 4
OSCILLATOR equ _XT_OSC_1H
        else
OSCILLATOR equ _HS_OSC_1H
        endif
        endif

configuration code 0x300000
        db      0x00, OSCILLATOR & _OSCS_OFF_1H & 0x27
        db      _PWRT_ON_2L & _BOR_ON_2L & _BORV_42_2L & 0x0F, _WDT_ON_2H & _WDTPS_8_2H & 0x0F
        db      0x00, _CCP2MX_ON_3H & 0x01
        db      _STVR_ON_4L & _LVP_OFF_4L & _DEBUG_OFF_4L & 0x85, 0x00
        db      0x0F, 0xC0
        db      0x0F, 0xE0
        db      0x0F, 0x40
        end
