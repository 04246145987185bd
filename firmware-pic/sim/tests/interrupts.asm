; SPDX-License-Identifier: GPL-2.0-or-later
; Reception at high priority (echo), a 1 ms tick of Timer2 (toggles RE1) and the change of RB4 to RB7 (toggles RD2)
; at low priority, over a main loop of one two-cycle instruction.
        list    p=18f452
        include "p18f452.inc"
        include "config_18f452.inc"
        CONFIGURATION   _WDT_OFF_2H

        org     0x0000
        goto    start
        org     0x0008
        goto    reception
        org     0x0018
        btfss   PIR1, TMR2IF
        bra     change
        bcf     PIR1, TMR2IF
        btg     LATE, 1
change: btfss   INTCON, RBIF
        bra     return_low
        movf    PORTB, W
        bcf     INTCON, RBIF
        btg     LATD, 2
        fill    (nop), 0x0040 - $
        org     0x0040
return_low:
        retfie

        fill    (nop), 0x0050 - $
        org     0x0050
reception:
        movff   RCREG, TXREG
        fill    (nop), 0x0060 - $
        org     0x0060
        retfie  FAST

        org     0x0080
start:  movlw   0x07
        movwf   ADCON1
        bcf     TRISE, 1
        bcf     TRISD, 2
        bcf     TRISC, 6
        movlw   .42
        movwf   SPBRG
        movlw   0x24
        movwf   TXSTA
        movlw   0x90
        movwf   RCSTA
        movlw   .249
        movwf   PR2
        clrf    IPR1
        bsf     IPR1, RCIP
        bcf     INTCON2, RBIP
        movlw   0x22            ; RCIE, TMR2IE
        movwf   PIE1
        bsf     INTCON, RBIE
        bsf     RCON, IPEN
        movf    PORTB, W
        bcf     INTCON, RBIF
        movlw   0xC0            ; GIEH, GIEL
        iorwf   INTCON
        movlw   0x4D            ; 1:4, 1:10, on
        movwf   T2CON
        fill    (nop), 0x0100 - $
        org     0x0100
main:   bra     main
        end
