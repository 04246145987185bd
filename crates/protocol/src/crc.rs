//! The check over a package: 16 bits, polynomial 0x5935 processed least significant bit first,
//! initial value 0xFFFF, no final xor, over the line bytes before the check.
//!
//! The polynomial is chosen so that every error of up to four bits and every burst of up to 16
//! line bits in a package of either length is seen; the crate's tests show it exhaustively.

/// The polynomial 0x5935 with its bits reversed, since bytes go least significant bit first.
pub const POLYNOMIAL_REVERSED: u16 = 0xAC9A;

/// What the check starts from.
pub const INITIAL: u16 = 0xFFFF;

const TABLE: [u16; 256] = {
    let mut table = [0; 256];
    let mut index = 0u16;
    while index < 256 {
        let mut value = index;
        let mut bit = 0;
        while bit < 8 {
            value = if value & 1 == 0 { value >> 1 } else { value >> 1 ^ POLYNOMIAL_REVERSED };
            bit += 1;
        }
        table[index as usize] = value;
        index += 1;
    }
    table
};

/// The check after one more byte.
#[inline]
pub const fn update(check: u16, byte: u8) -> u16 {
    check >> 8 ^ TABLE[((check ^ byte as u16) & 0xFF) as usize]
}

/// The check over `bytes`.
pub fn checksum(bytes: &[u8]) -> u16 {
    bytes.iter().fold(INITIAL, |check, byte| update(check, *byte))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const REFERENCE: crc::Crc<u16> = crc::Crc::<u16>::new(&crc::Algorithm {
        width: 16,
        poly: 0x5935,
        init: 0xFFFF,
        refin: true,
        refout: true,
        xorout: 0,
        check: 0x328D,
        residue: 0,
    });

    #[test]
    fn check_value_of_the_specification() {
        assert_eq!(checksum(b"123456789"), 0x328D);
    }

    proptest! {
        #[test]
        fn equals_the_crc_crate(bytes in prop::collection::vec(any::<u8>(), 0..64)) {
            prop_assert_eq!(checksum(&bytes), REFERENCE.checksum(&bytes));
        }
    }
}
