/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The special function registers that this firmware uses, by the names of the data sheets
 * (PIC18FXX2: DS39564, PIC18F2220/2320/4220/4320: DS39599).
 *
 * SFR_LIST(REGISTER, BIT) is the one table: REGISTER(name, address) for each register and
 * BIT(register, name, number) for each of its bits that has a name here. Both chips have the
 * same registers at the same places but for those of their ports. check_sfr.py compares it with
 * the include files of the assembler.
 */
#ifndef RSAPIEN_PIC18_SFR_H
#define RSAPIEN_PIC18_SFR_H

#define SFR_LIST_BOTH(REGISTER, BIT)                                                               \
    REGISTER(PORTA, 0xF80)                                                                         \
    REGISTER(PORTB, 0xF81)                                                                         \
    REGISTER(LATA, 0xF89)                                                                          \
    REGISTER(LATB, 0xF8A)                                                                          \
    REGISTER(LATC, 0xF8B)                                                                          \
    REGISTER(TRISA, 0xF92)                                                                         \
    REGISTER(TRISB, 0xF93)                                                                         \
    REGISTER(TRISC, 0xF94)                                                                         \
    REGISTER(PIE1, 0xF9D)                                                                          \
    BIT(PIE1, TMR2IE, 1)                                                                           \
    BIT(PIE1, TXIE, 4)                                                                             \
    BIT(PIE1, RCIE, 5)                                                                             \
    REGISTER(PIR1, 0xF9E)                                                                          \
    BIT(PIR1, TMR2IF, 1)                                                                           \
    BIT(PIR1, TXIF, 4)                                                                             \
    BIT(PIR1, RCIF, 5)                                                                             \
    REGISTER(IPR1, 0xF9F)                                                                          \
    BIT(IPR1, RCIP, 5)                                                                             \
    REGISTER(EECON1, 0xFA6)                                                                        \
    BIT(EECON1, RD, 0)                                                                             \
    BIT(EECON1, WR, 1)                                                                             \
    BIT(EECON1, WREN, 2)                                                                           \
    REGISTER(EECON2, 0xFA7)                                                                        \
    REGISTER(EEDATA, 0xFA8)                                                                        \
    REGISTER(EEADR, 0xFA9)                                                                         \
    REGISTER(RCSTA, 0xFAB)                                                                         \
    BIT(RCSTA, OERR, 1)                                                                            \
    BIT(RCSTA, FERR, 2)                                                                            \
    BIT(RCSTA, CREN, 4)                                                                            \
    BIT(RCSTA, SPEN, 7)                                                                            \
    REGISTER(TXSTA, 0xFAC)                                                                         \
    BIT(TXSTA, BRGH, 2)                                                                            \
    BIT(TXSTA, TXEN, 5)                                                                            \
    REGISTER(TXREG, 0xFAD)                                                                         \
    REGISTER(RCREG, 0xFAE)                                                                         \
    REGISTER(SPBRG, 0xFAF)                                                                         \
    REGISTER(CCP2CON, 0xFBA)                                                                       \
    REGISTER(CCPR2L, 0xFBB)                                                                        \
    REGISTER(CCPR2H, 0xFBC)                                                                        \
    REGISTER(CCP1CON, 0xFBD)                                                                       \
    REGISTER(CCPR1L, 0xFBE)                                                                        \
    REGISTER(CCPR1H, 0xFBF)                                                                        \
    REGISTER(ADCON1, 0xFC1)                                                                        \
    REGISTER(T2CON, 0xFCA)                                                                         \
    BIT(T2CON, TMR2ON, 2)                                                                          \
    REGISTER(PR2, 0xFCB)                                                                           \
    REGISTER(T1CON, 0xFCD)                                                                         \
    BIT(T1CON, TMR1ON, 0)                                                                          \
    BIT(T1CON, RD16, 7)                                                                            \
    REGISTER(TMR1L, 0xFCE)                                                                         \
    REGISTER(TMR1H, 0xFCF)                                                                         \
    REGISTER(RCON, 0xFD0)                                                                          \
    BIT(RCON, NOT_BOR, 0)                                                                          \
    BIT(RCON, NOT_POR, 1)                                                                          \
    BIT(RCON, NOT_TO, 3)                                                                           \
    BIT(RCON, NOT_RI, 4)                                                                           \
    BIT(RCON, IPEN, 7)                                                                             \
    REGISTER(STATUS, 0xFD8)                                                                        \
    REGISTER(FSR2L, 0xFD9)                                                                         \
    REGISTER(FSR2H, 0xFDA)                                                                         \
    REGISTER(PLUSW2, 0xFDB)                                                                        \
    REGISTER(POSTINC2, 0xFDE)                                                                      \
    REGISTER(INDF2, 0xFDF)                                                                         \
    REGISTER(BSR, 0xFE0)                                                                           \
    REGISTER(FSR1L, 0xFE1)                                                                         \
    REGISTER(FSR1H, 0xFE2)                                                                         \
    REGISTER(PLUSW1, 0xFE3)                                                                        \
    REGISTER(PREINC1, 0xFE4)                                                                       \
    REGISTER(POSTDEC1, 0xFE5)                                                                      \
    REGISTER(POSTINC1, 0xFE6)                                                                      \
    REGISTER(WREG, 0xFE8)                                                                          \
    REGISTER(FSR0L, 0xFE9)                                                                         \
    REGISTER(FSR0H, 0xFEA)                                                                         \
    REGISTER(PLUSW0, 0xFEB)                                                                        \
    REGISTER(POSTINC0, 0xFEE)                                                                      \
    REGISTER(INDF0, 0xFEF)                                                                         \
    REGISTER(INTCON2, 0xFF1)                                                                       \
    BIT(INTCON2, RBIP, 0)                                                                          \
    BIT(INTCON2, NOT_RBPU, 7)                                                                      \
    REGISTER(INTCON, 0xFF2)                                                                        \
    BIT(INTCON, RBIF, 0)                                                                           \
    BIT(INTCON, RBIE, 3)                                                                           \
    BIT(INTCON, GIEL, 6)                                                                           \
    BIT(INTCON, GIEH, 7)                                                                           \
    REGISTER(PRODL, 0xFF3)                                                                         \
    REGISTER(PRODH, 0xFF4)                                                                         \
    REGISTER(TABLAT, 0xFF5)                                                                        \
    REGISTER(TBLPTRL, 0xFF6)                                                                       \
    REGISTER(TBLPTRH, 0xFF7)                                                                       \
    REGISTER(TBLPTRU, 0xFF8)                                                                       \
    REGISTER(PCL, 0xFF9)                                                                           \
    REGISTER(PCLATH, 0xFFA)                                                                        \
    REGISTER(PCLATU, 0xFFB)                                                                        \
    REGISTER(STKPTR, 0xFFC)                                                                        \
    BIT(STKPTR, STKUNF, 6)                                                                         \
    BIT(STKPTR, STKFUL, 7)

/* The motion controller's chip has 40 pins: two ports more. */
#define SFR_LIST_18F452(REGISTER, BIT)                                                             \
    REGISTER(LATD, 0xF8C)                                                                          \
    REGISTER(LATE, 0xF8D)                                                                          \
    REGISTER(TRISD, 0xF95)                                                                         \
    REGISTER(TRISE, 0xF96)

#ifdef RSAPIEN_MOTION
#define SFR_LIST(REGISTER, BIT) SFR_LIST_BOTH(REGISTER, BIT) SFR_LIST_18F452(REGISTER, BIT)
#else
#define SFR_LIST(REGISTER, BIT) SFR_LIST_BOTH(REGISTER, BIT)
#endif

#define SFR_NOTHING_OF_BIT(register_name, name, number)
#define SFR_NOTHING_OF_REGISTER(name, address)

/* Where other compilers look at this port, a register is a byte of memory somewhere. */
#ifdef __SDCC
#define SFR_DECLARE(name, address) extern __sfr __at(address) name;
#else
#define SFR_DECLARE(name, address) extern volatile unsigned char name;
#endif
SFR_LIST(SFR_DECLARE, SFR_NOTHING_OF_BIT)

/* The bits, as masks: PIR1_TMR2IF and so on. */
#define SFR_MASK(register_name, name, number) register_name##_##name = 1 << (number),
enum sfr_mask { SFR_LIST(SFR_NOTHING_OF_REGISTER, SFR_MASK) SFR_MASK_END };

#endif
