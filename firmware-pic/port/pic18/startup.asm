; SPDX-License-Identifier: MIT OR Apache-2.0
; From reset to main(). RAM_BANKS (from the Makefile): the chip's RAM in banks of 256 bytes.
;
; Motors off comes before anything else (but for the interrupts). There is no initialised data to copy: the build fails when
; there is any. The stack of the compiled code grows down from _stack_end, in one bank (FSR2H, which
; functions do not save, then never changes); the linker reserves it.

        extern  _main
        extern  _pins_reset
        extern  _stack_end
        radix   dec

FSR0H   equ     0xFEA
POSTINC0 equ    0xFEE
INTCON  equ     0xFF2

reset_vector code 0x0000
        goto    start

startup code
start:
        ; 0 after a reset, but not after a wild jump to address 0.
        clrf    INTCON, 0
        call    _pins_reset
        lfsr    0, 0
clear:
        clrf    POSTINC0, 0
        movlw   RAM_BANKS
        cpfseq  FSR0H, 0
        bra     clear
        lfsr    1, _stack_end
        lfsr    2, _stack_end
        goto    _main
        end
