//! A state as bytes.

use super::state::State;
use crate::error::ContactError;
use signorini_fem_mesh::internal::replace_file;
use std::path::Path;

/// Marks the format of stored states.
const MAGIC: u32 = 0x5349_4712;

/// FNV-1a of 64 bits: any one changed byte changes it.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

impl State {
    /// Writes the state as bytes (feature `checkpoint`): a number for the format (4 bytes) and a checksum of the rest
    /// (8 bytes, FNV-1a), both little-endian, then the state in the encoding of postcard.
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

    /// Reads what [`to_bytes`](Self::to_bytes) wrote (feature `checkpoint`). The checksum finds damage by chance; it is
    /// no protection against bytes made on purpose.
    ///
    /// # Errors
    /// [`ContactError::UnreadableCheckpoint`] if the bytes are of another format, cut, changed, or followed by others.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ContactError> {
        let error = |reason: String| ContactError::UnreadableCheckpoint { reason };
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
        let (state, rest) = postcard::take_from_bytes(payload).map_err(|e| damaged(&e.to_string()))?;
        if rest.is_empty() { Ok(state) } else { Err(damaged("more follows the state")) }
    }

    /// Stores the state in a file (feature `checkpoint`). The file is complete at any moment: a kill or a full disk
    /// leaves the state that was there before.
    ///
    /// # Errors
    /// [`ContactError::CheckpointFile`] if the file system refuses.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), ContactError> {
        replace_file(&path, &self.to_bytes()?).map_err(failed("write", path.as_ref()))
    }

    /// Reads what [`save`](Self::save) stored (feature `checkpoint`).
    ///
    /// # Errors
    /// [`ContactError::CheckpointFile`] if the file system refuses, with [`NotFound`](std::io::ErrorKind::NotFound)
    /// where there is no file yet; as [`from_bytes`](Self::from_bytes), with the file.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ContactError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(failed("read", path))?;
        let named = |reason| format!("{}: {reason}", path.display());
        Self::from_bytes(&bytes).map_err(|error| explained(error, named))
    }
}

/// The same error with more to say of the checkpoint.
pub(crate) fn explained(error: ContactError, text: impl FnOnce(String) -> String) -> ContactError {
    match error {
        ContactError::Checkpoint { reason } => ContactError::Checkpoint { reason: text(reason) },
        ContactError::UnreadableCheckpoint { reason } => ContactError::UnreadableCheckpoint { reason: text(reason) },
        other => other,
    }
}

/// What the file system refuses.
pub(crate) fn failed<'a>(what: &'static str, path: &'a Path) -> impl FnOnce(std::io::Error) -> ContactError + 'a {
    move |source| ContactError::CheckpointFile {
        what,
        path: path.into(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::state::tests::state;

    #[test]
    fn bytes_round_trip_and_damage_is_noticed() {
        let state = state();
        let bytes = state.to_bytes().unwrap();
        assert_eq!(State::from_bytes(&bytes).unwrap(), state);
        assert!(matches!(
            State::from_bytes(&bytes[..bytes.len() - 1]),
            Err(ContactError::UnreadableCheckpoint { .. })
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
    fn a_file_is_the_new_state_or_the_old_one() {
        let folder = std::env::temp_dir().join(format!("signorini-state-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("state.bin");
        let absent = State::load(&path).unwrap_err();
        let text = absent.to_string();
        assert!(text.contains("cannot read") && text.contains("state.bin"));
        assert!(matches!(
            absent,
            ContactError::CheckpointFile { source, .. } if source.kind() == std::io::ErrorKind::NotFound
        ));
        state().save(&path).unwrap();
        assert_eq!(State::load(&path).unwrap(), state());
        // what is written beside it fails
        let beside = folder.join("state.bin.tmp");
        std::fs::create_dir(&beside).unwrap();
        let mut other = state();
        other.note_unconverged();
        let error = other.save(&path).unwrap_err().to_string();
        assert!(error.contains("cannot write") && error.contains("state.bin.tmp"));
        assert_eq!(State::load(&path).unwrap(), state());
        std::fs::remove_dir(&beside).unwrap();
        // a cut file that a kill left beside it
        std::fs::write(&beside, [1, 2, 3]).unwrap();
        other.save(&path).unwrap();
        assert_eq!(State::load(&path).unwrap(), other);
        assert!(!beside.exists());
        std::fs::write(&path, [0; 30]).unwrap();
        let error = State::load(&path).unwrap_err().to_string();
        assert!(error.contains("state.bin") && error.contains("no state"));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn the_checksum_is_fnv_1a() {
        // published values
        assert_eq!(checksum(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(checksum(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(checksum(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
