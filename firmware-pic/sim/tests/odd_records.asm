; SPDX-License-Identifier: GPL-2.0-or-later
; CONFIG writes a record that begins at the odd address 0x300001. With the watchdog off nothing resets the loop.
        list    p=18f452
        include "p18f452.inc"
        CONFIG  OSC = HSPLL, WDT = OFF, LVP = OFF, STVR = ON

        org     0x0000
        bra     $
        end
