//! The check over a package: 16 bits, polynomial 0x5935 processed least significant bit first,
//! initial value 0xFFFF, no final xor, over the line bytes before the check.
//!
//! The polynomial is chosen so that every error of up to four bits and every burst of up to 16
//! line bits in a package of either length is seen; the crate's tests show it exhaustively.

use crate::frame::GROUP_DATA_LENGTH;

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

/// What a byte contributes when `index` bytes of its group come behind it. Only programs that take
/// whole groups link these tables; a controller needs none but the first.
static GROUP_TABLES: [[u16; 256]; GROUP_LENGTH] = {
    let mut tables = [TABLE; GROUP_LENGTH];
    let mut index = 1;
    while index < GROUP_LENGTH {
        let mut byte = 0;
        while byte < 256 {
            tables[index][byte] = update(tables[index - 1][byte], 0);
            byte += 1;
        }
        index += 1;
    }
    tables
};

const GROUP_LENGTH: usize = GROUP_DATA_LENGTH + 1;

/// The check after a whole group, all of whose bytes are looked up at once.
#[inline]
pub(crate) fn update_group(check: u16, group: [u8; GROUP_LENGTH]) -> u16 {
    let [low, high] = check.to_le_bytes();
    let [first, second, others @ ..] = group;
    let tables = &GROUP_TABLES;
    let begun = tables[6][usize::from(first ^ low)] ^ tables[5][usize::from(second ^ high)];
    let others = tables[4][usize::from(others[0])]
        ^ tables[3][usize::from(others[1])]
        ^ tables[2][usize::from(others[2])]
        ^ tables[1][usize::from(others[3])]
        ^ tables[0][usize::from(others[4])];
    begun ^ others
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

        #[test]
        fn a_group_at_once_equals_its_bytes(check in any::<u16>(), group in any::<[u8; 7]>()) {
            prop_assert_eq!(update_group(check, group), group.into_iter().fold(check, update));
        }
    }
}
