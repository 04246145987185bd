; SPDX-License-Identifier: GPL-2.0-or-later
; With RB0 low: RCSTA to 0x20, RCREG to 0x10, RCSTA to 0x21, RCREG to 0x11, RCSTA to 0x22.
        list    p=18f452
        include "p18f452.inc"
        include "config_18f452.inc"
        CONFIGURATION   _WDT_OFF_2H

        org     0x0000
        movlw   .42
        movwf   SPBRG
        movlw   0x24            ; TXEN, BRGH
        movwf   TXSTA
        movlw   0x90            ; SPEN, CREN
        movwf   RCSTA
wait:   btfsc   PORTB, 0
        bra     wait
        movff   RCSTA, 0x20
        movff   RCREG, 0x10
        movff   RCSTA, 0x21
        movff   RCREG, 0x11
        movff   RCSTA, 0x22
        bra     $
        end
