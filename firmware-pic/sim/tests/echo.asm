; SPDX-License-Identifier: GPL-2.0-or-later
; Echoes each byte at 57600 baud (40 MHz). A byte with a framing error is answered with 0xEE,
; 0xB0 with a zero at a sixth of the rate, 0xE0 with the EEPROM byte 0 after it went up by one.
; RB0 is copied to RD1; RD0 toggles at each byte.
        list    p=18f452
        include "p18f452.inc"
        include "config_18f452.inc"
        CONFIGURATION   _WDT_OFF_2H

value   equ     0x10

        org     0x0000
        goto    start
        org     0x0020
start:  clrf    LATD
        movlw   0xFC
        movwf   TRISD
        bcf     TRISC, 6        ; TX drives its pin only as an output
        movlw   .42
        movwf   SPBRG
        movlw   0x24            ; TXEN, BRGH
        movwf   TXSTA
        movlw   0x90            ; SPEN, CREN
        movwf   RCSTA
loop:   clrwdt
        btfss   PORTB, 0
        bcf     LATD, 1
        btfsc   PORTB, 0
        bsf     LATD, 1
        btfss   PIR1, RCIF
        bra     loop
        btfsc   RCSTA, FERR
        bra     framing
received:
        movff   RCREG, value
        btg     LATD, 0
        movlw   0xB0
        cpfseq  value
        bra     not_break
        bra     break
not_break:
        movlw   0xE0
        cpfseq  value
        bra     send
        call    count_up
send:   btfss   PIR1, TXIF
        bra     send
        movff   value, TXREG
        bra     loop
framing:
        movf    RCREG, W
        movlw   0xEE
        movwf   value
        bra     send

; A byte of zeros at a sixth of the rate: no stop bit where the line expects one.
break:  btfss   TXSTA, TRMT
        bra     break
        setf    SPBRG
        clrf    TXREG
        nop
slow:   btfss   TXSTA, TRMT
        bra     slow
        movlw   .42
        movwf   SPBRG
        bra     loop

count_up:
        clrf    EEADR
        movlw   0x01            ; RD
        movwf   EECON1
        incf    EEDATA, F
        movlw   0x04            ; WREN
        movwf   EECON1
        movlw   0x55
        movwf   EECON2
        movlw   0xAA
        movwf   EECON2
        bsf     EECON1, WR
written:
        btfsc   EECON1, WR
        bra     written
        movff   EEDATA, value
        return
        end
