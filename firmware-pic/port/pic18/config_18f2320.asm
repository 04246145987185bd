; SPDX-License-Identifier: MIT OR Apache-2.0
; Configuration words of the camera controller, PIC18F2320. CLOCK_MHZ comes from the Makefile.
; See config_18f452.asm for why they stand as bytes.
;
; Oscillator: 10 MHz crystal and PLL for 40 MHz; crystals of 20, 10 and 4 MHz as they are.
; Watchdog: on, 4 ms * 32 = 128 ms. Brown-out: below 4.2 V, which is what the chip needs.
; MCLR is a pin. Port B is digital from reset on. Nothing is protected against reading or writing.

        include "p18f2320.inc"

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
        db      0x00, OSCILLATOR & _FSCM_OFF_1H & _IESO_OFF_1H & 0xCF
        db      _PWRT_ON_2L & _BOR_ON_2L & _BORV_42_2L & 0x0F, _WDT_ON_2H & _WDTPS_32_2H & 0x1F
        db      0x00, _CCP2MX_ON_3H & _PBAD_DIG_3H & _MCLRE_ON_3H & 0x83
        db      _STVR_ON_4L & _LVP_OFF_4L & _DEBUG_OFF_4L & 0x85, 0x00
        db      0x0F, 0xC0
        db      0x0F, 0xE0
        db      0x0F, 0x40
        end
