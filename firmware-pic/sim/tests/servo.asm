; SPDX-License-Identifier: GPL-2.0-or-later
; Pulses of 1500 cycles every 6500 on RC2 (CCP1) and, 100 cycles later, RC1 (CCP2), whose edges the compare units make.
; The modes 8 (match: high) and 9 (match: low) follow each other without a 0, which works on the chip as well.
        list    p=18f2320
        include "p18f2320.inc"
        org     0x300000
        db      0x00, _HSPLL_OSC_1H & _FSCM_OFF_1H & _IESO_OFF_1H & 0xCF
        db      _PWRT_ON_2L & _BOR_ON_2L & _BORV_27_2L & 0x0F, _WDT_OFF_2H & 0x1F
        db      0x00, _CCP2MX_ON_3H & _PBAD_DIG_3H & _MCLRE_ON_3H & 0x83
        db      _STVR_ON_4L & _LVP_OFF_4L & _DEBUG_OFF_4L & 0x85, 0x00
        db      0x0F, 0xC0, 0x0F, 0xE0, 0x0F, 0x40

width   equ     .1500
gap     equ     .5000
later   equ     0x10            ; two bytes

first   macro   match, cycle
        movlw   LOW(cycle)
        movwf   match
        movlw   HIGH(cycle)
        movwf   match + 1
        endm

        org     0x0000
        bcf     TRISC, 2
        bcf     TRISC, 1
        movlw   0x81            ; 16 bits at once, 1:1, on
        movwf   T1CON
        movlw   .249
        movwf   PR2
        movlw   0x4D            ; a tick of Timer2, which has nothing to do with all this
        movwf   T2CON
        first   CCPR1L, .2000
        first   CCPR2L, .2100
pulse:  movlw   0x08
        rcall   match
        first   later, width
        rcall   move_on
        movlw   0x09
        rcall   match
        first   later, gap
        rcall   move_on
        bra     pulse

match:  movwf   CCP1CON
        movwf   CCP2CON
        bcf     PIR2, CCP2IF
wait:   btfss   PIR2, CCP2IF
        bra     wait
        return

move_on:
        movf    later, W
        addwf   CCPR1L
        movf    later + 1, W
        addwfc  CCPR1H
        movf    later, W
        addwf   CCPR2L
        movf    later + 1, W
        addwfc  CCPR2H
        return
        end
