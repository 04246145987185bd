; SPDX-License-Identifier: GPL-2.0-or-later
; Edges and marks at known cycles: RD0 goes up and down with a period of 100 cycles, 40 of them high.
        list    p=18f452
        include "p18f452.inc"
        include "config_18f452.inc"
        CONFIGURATION   _WDT_OFF_2H

count   equ     0x10

        org     0x0000
        goto    start
        org     0x0020
start:  bcf     LATD, 0
        bcf     TRISD, 0
loop:   bsf     LATD, 0         ; 1, and to the bcf: 1 + 2 + 1 + (3 * 11 - 1) + 2 + 1 = 39
        movlw   .11
        call    wait
        nop
        bcf     LATD, 0         ; 1, and to the bsf: 1 + 2 + 1 + (3 * 17 - 1) + 2 + 1 + 2 = 59
        movlw   .17
        call    wait
        nop
        bra     loop
wait:   movwf   count
again:  decfsz  count
        bra     again
        return
        end
