//! A state as bytes.

use super::State;
use crate::error::ContactError;

/// Marks the format of stored states.
const MAGIC: u32 = 0x5349_470a;

/// FNV-1a of 64 bits: any one changed byte changes it.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

impl State {
    /// Writes the state as bytes (feature `checkpoint`): a number for the format (4 bytes) and a checksum of the rest (8 bytes,
    /// FNV-1a), both little-endian, then the state in the encoding of postcard.
    ///
    /// # Errors
    /// [`ContactError::Checkpoint`] if the encoder fails.
    pub fn to_bytes(&self) -> Result<Vec<u8>, ContactError> {
        let payload = postcard::to_stdvec(self).map_err(|e| ContactError::Checkpoint {
            reason: format!("the state cannot be encoded ({e})"),
        })?;
        let mut bytes = MAGIC.to_le_bytes().to_vec();
        bytes.extend(checksum(&payload).to_le_bytes());
        bytes.extend(payload);
        Ok(bytes)
    }

    /// Reads what [`to_bytes`](Self::to_bytes) wrote (feature `checkpoint`). The checksum finds damage by chance; it is no
    /// protection against bytes made on purpose.
    ///
    /// # Errors
    /// [`ContactError::Checkpoint`] if the bytes are of another format, cut, changed, or followed by others.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ContactError> {
        let error = |reason: String| ContactError::Checkpoint { reason };
        let damaged = |how: &str| {
            error(format!(
                "the bytes are damaged ({how}); use an earlier checkpoint or start anew"
            ))
        };
        let (magic, rest) = bytes.split_first_chunk().ok_or_else(|| damaged("cut"))?;
        let found = u32::from_le_bytes(*magic);
        if found != MAGIC {
            let what = match (found ^ MAGIC) >> 8 {
                0 => format!(
                    "the bytes have format {}, this version reads format {}",
                    found & 0xff,
                    MAGIC & 0xff
                ),
                _ => return Err(error("another format: the bytes are no state".to_owned())),
            };
            return Err(error(format!(
                "{what}; read it with the version that wrote it, or start anew"
            )));
        }
        let (sum, payload) = rest.split_first_chunk().ok_or_else(|| damaged("cut"))?;
        if u64::from_le_bytes(*sum) != checksum(payload) {
            return Err(damaged("their checksum differs"));
        }
        let (state, rest) =
            postcard::take_from_bytes(payload).map_err(|e| damaged(&e.to_string()))?;
        if rest.is_empty() {
            Ok(state)
        } else {
            Err(damaged("more follows the state"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::tests::state;

    #[test]
    fn bytes_round_trip_and_damage_is_noticed() {
        let state = state();
        let bytes = state.to_bytes().unwrap();
        assert_eq!(State::from_bytes(&bytes).unwrap(), state);
        assert!(matches!(
            State::from_bytes(&bytes[..bytes.len() - 1]),
            Err(ContactError::Checkpoint { .. })
        ));
        assert!(State::from_bytes(&[0; 40]).is_err());
        for at in 0..8 * bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at / 8] ^= 1 << (at % 8);
            assert!(State::from_bytes(&damaged).is_err(), "bit {at}");
        }
        // bytes behind it, first as they are, then with the checksum that belongs to them
        let mut longer = bytes.clone();
        longer.push(0);
        let text = |bytes: &[u8]| State::from_bytes(bytes).unwrap_err().to_string();
        assert!(text(&longer).contains("checksum"));
        let sum = checksum(&longer[12..]);
        longer[4..12].copy_from_slice(&sum.to_le_bytes());
        assert!(text(&longer).contains("more follows"));
    }

    #[test]
    fn bytes_of_an_earlier_version_are_refused_with_its_number() {
        let mut bytes = state().to_bytes().unwrap();
        bytes[..4].copy_from_slice(&0x5349_4706_u32.to_le_bytes());
        let text = State::from_bytes(&bytes).unwrap_err().to_string();
        assert!(text.contains("format 6"), "{text}");
        bytes[3] = 0;
        let text = State::from_bytes(&bytes).unwrap_err().to_string();
        assert!(text.contains("no state"), "{text}");
    }

    #[test]
    fn the_checksum_is_fnv_1a() {
        // published values
        assert_eq!(checksum(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(checksum(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(checksum(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
