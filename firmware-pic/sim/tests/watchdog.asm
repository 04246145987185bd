; SPDX-License-Identifier: GPL-2.0-or-later
; Never clears the watchdog (postscaler 1:2). Port D shows RCON as found at the start; EEPROM byte 1 and
; register 0x20 count the starts, RAM 0x20 being cleared at power-on alone.
        list    p=18f452
        include "p18f452.inc"
        include "config_18f452.inc"
        CONFIGURATION   _WDT_ON_2H & _WDTPS_2_2H

starts  equ     0x20

        org     0x0000
        goto    start
        org     0x0020
start:  clrf    TRISD
        movff   RCON, LATD
        btfsc   RCON, NOT_POR
        bra     counted
        clrf    starts
counted:
        incf    starts
        movlw   0x1F            ; RI, POR, BOR (and TO, PD, which stay as they are)
        movwf   RCON
        btfss   PORTB, 0        ; with RB0 low: a stack overflow instead of waiting
overflow:
        rcall   overflow
        btfss   PORTB, 1        ; with RB1 low: the RESET instruction
        reset
forever:
        bra     forever
        end
