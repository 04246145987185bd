; SPDX-License-Identifier: GPL-2.0-or-later
; When RB0 falls: sends 0x41 and, register 0x20 times 12 and register 0x21 cycles and some more later, 0x42.
        list    p=18f452
        include "p18f452.inc"
        include "config_18f452.inc"
        CONFIGURATION   _WDT_OFF_2H

dozens  equ     0x20
rest    equ     0x21            ; 0 to 11

        org     0x0000
        bcf     TRISC, 6
        movlw   .42
        movwf   SPBRG
        movlw   0x24            ; TXEN, BRGH
        movwf   TXSTA
        movlw   0x90            ; SPEN, CREN
        movwf   RCSTA
open:   btfss   PORTB, 0
        bra     open
closed: btfsc   PORTB, 0
        bra     closed
        movlw   0x41
        movwf   TXREG
dozen:  goto    $+4
        goto    $+4
        goto    $+4
        goto    $+4
        nop
        decfsz  dozens
        bra     dozen
        movlw   LOW(sled) + .22
        bcf     STATUS, C
        rlcf    rest            ; a nop has two bytes
        bsf     STATUS, C
        subfwb  rest, W
        clrf    PCLATH
        movwf   PCL
sled:   nop
        nop
        nop
        nop
        nop
        nop
        nop
        nop
        nop
        nop
        nop
        movlw   0x42
        movwf   TXREG
        bra     open
        end
