//! Runs in files.
//!
//! A file is a magic word, the version of the format, the length of what follows, the run as
//! postcard encodes it, and a CRC-64 of all that. It is written beside the old one, flushed to the
//! disk and then renamed, so that there is a whole file at any time.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use crc::{CRC_64_XZ, Crc};
use serde::{Deserialize, Serialize};

use super::error::CheckpointError;
use super::state::Round;

const MAGIC: [u8; 8] = *b"mis-run\n";

/// Changes whenever old files cannot be continued.
const VERSION: u32 = 1;

const HEADER: usize = MAGIC.len() + 4 + 8;

const CHECKSUM: usize = 8;

const CRC: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// What makes a run this run: all that its bits depend on, as far as it can be told.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Identity {
    /// Design, shares and faults of the estimator.
    pub(super) estimator: String,
    pub(super) components: usize,
    /// How many sums a tally has.
    pub(super) sums: usize,
    /// Of the points, weights and contributions of the first samples: what seed, techniques,
    /// weighting and integrand come to.
    pub(super) first_samples: u64,
    /// Of what a tally makes of them.
    pub(super) first_sums: u64,
    pub(super) label: String,
}

impl Identity {
    /// The first difference, in words.
    fn difference(&self, other: &Self) -> Option<String> {
        let differ = |what: &str, a: &dyn std::fmt::Debug, b: &dyn std::fmt::Debug| {
            Some(format!("its {what} is {a:?}, not {b:?}"))
        };
        if self.label != other.label {
            differ("label", &self.label, &other.label)
        } else if self.components != other.components {
            differ("number of components", &self.components, &other.components)
        } else if self.sums != other.sums {
            differ("number of sums", &self.sums, &other.sums)
        } else if self.estimator != other.estimator {
            differ("estimator", &self.estimator, &other.estimator)
        } else if self.first_samples != other.first_samples {
            Some(
                "its first samples contribute something else: another seed, integrand, technique, \
                 weighting, or build"
                    .into(),
            )
        } else if self.first_sums != other.first_sums {
            Some("its sums are of something else".into())
        } else {
            None
        }
    }
}

/// One of several processes that divide a run among them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Shard {
    pub(super) index: u64,
    pub(super) of: u64,
}

/// All that a file holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Saved {
    pub(super) identity: Identity,
    pub(super) shard: Shard,
    /// The most samples that the run was to draw; shards divide them.
    pub(super) limit: u64,
    pub(super) rounds: Vec<Round>,
}

impl Saved {
    /// # Errors
    ///
    /// The file is of another run, or of another shard of it.
    pub(super) fn check(
        &self,
        path: &Path,
        identity: &Identity,
        shard: Shard,
    ) -> Result<(), CheckpointError> {
        let mut difference = self.identity.difference(identity);
        if difference.is_none() && self.shard != shard {
            let name = |shard: Shard| format!("shard {} of {}", shard.index, shard.of);
            difference = Some(format!("it is {}, not {}", name(self.shard), name(shard)));
        }
        match difference {
            Some(difference) => Err(CheckpointError::OtherRun { path: path.into(), difference }),
            None => Ok(()),
        }
    }
}

/// The CRC-64 of some words.
pub(super) fn digest(words: impl IntoIterator<Item = u64>) -> u64 {
    let mut digest = CRC.digest();
    for word in words {
        digest.update(&word.to_le_bytes());
    }
    digest.finalize()
}

/// The run in the file at `path`; `None` if there is no file.
pub(super) fn load(path: &Path) -> Result<Option<Saved>, CheckpointError> {
    match fs::read(path) {
        Ok(bytes) => decode(&bytes)
            .map(Some)
            .map_err(|problem| CheckpointError::Damaged { path: path.into(), problem }),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(system(path, "reading", error)),
    }
}

/// Puts the run into the file at `path`, all of it or nothing.
pub(super) fn save(path: &Path, saved: &Saved) -> Result<(), CheckpointError> {
    // Two runs of this process may save to one file: they would share the temporary file, too.
    static WRITING: Mutex<()> = Mutex::new(());
    let bytes =
        encode(saved).map_err(|problem| CheckpointError::Damaged { path: path.into(), problem })?;
    let _alone = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    let temporary = beside(path);
    let write = || {
        let mut file = File::create(&temporary)?;
        file.write_all(&bytes)?;
        file.sync_all()?;
        fs::rename(&temporary, path)?;
        // The new name is on the disk when its folder is. Not every system can open one.
        if let Ok(folder) = File::open(folder_of(path)) {
            folder.sync_all().ok();
        }
        Ok(())
    };
    write().map_err(|error| {
        fs::remove_file(&temporary).ok();
        system(path, "writing", error)
    })
}

fn system(path: &Path, action: &'static str, error: std::io::Error) -> CheckpointError {
    CheckpointError::System { path: path.into(), action, error }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// A name in the same folder that no other process has.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(format!(".{}.tmp", std::process::id()));
    path.with_file_name(name)
}

fn encode(saved: &Saved) -> Result<Vec<u8>, String> {
    let payload = postcard::to_stdvec(saved).map_err(|error| error.to_string())?;
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((payload.len() as u64).to_le_bytes());
    bytes.extend(payload);
    bytes.extend(CRC.checksum(&bytes).to_le_bytes());
    Ok(bytes)
}

fn decode(bytes: &[u8]) -> Result<Saved, String> {
    let Some((magic, rest)) = bytes.split_first_chunk::<8>() else {
        return Err(format!("it has {} bytes, less than any checkpoint", bytes.len()));
    };
    if *magic != MAGIC {
        return Err("it does not begin like a checkpoint".into());
    }
    let (Some((version, rest)), true) =
        (rest.split_first_chunk::<4>(), bytes.len() >= HEADER + CHECKSUM)
    else {
        return Err(format!("it ends after {} bytes, within its header", bytes.len()));
    };
    let version = u32::from_le_bytes(*version);
    if version != VERSION {
        return Err(format!("its format is version {version}; this build reads {VERSION}"));
    }
    let Some((body, checksum)) = bytes.split_last_chunk::<CHECKSUM>() else {
        return Err("it has no checksum".into());
    };
    let length = rest.first_chunk::<8>().map_or(0, |length| u64::from_le_bytes(*length));
    if length != (bytes.len() - HEADER - CHECKSUM) as u64 {
        let found = bytes.len() - HEADER - CHECKSUM;
        return Err(format!(
            "it should hold {length} bytes and holds {found}: it was cut or joined"
        ));
    }
    if CRC.checksum(body) != u64::from_le_bytes(*checksum) {
        return Err("its checksum does not match: it was damaged".into());
    }
    let payload = body.get(HEADER..).unwrap_or_default();
    match postcard::take_from_bytes(payload) {
        Ok((saved, [])) => Ok(saved),
        Ok((_, rest)) => Err(format!("there are {} bytes too many", rest.len())),
        Err(error) => Err(format!("its contents cannot be read: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::{CRC, HEADER, Identity, Saved, Shard, beside, decode, digest, encode, folder_of};
    use crate::run::state::Round;
    use std::path::Path;

    fn saved() -> Saved {
        let identity = Identity {
            estimator: "multi-sample".into(),
            components: 2,
            sums: 3,
            first_samples: u64::MAX,
            first_sums: 5,
            label: "a".into(),
        };
        let shard = Shard { index: 1, of: 4 };
        Saved { identity, shard, limit: 1 << 53, rounds: vec![Round::default(); 2] }
    }

    /// A file with this payload and a checksum that is right.
    fn with_payload(payload: &[u8]) -> Vec<u8> {
        let mut bytes = encode(&saved()).unwrap()[..HEADER - 8].to_vec();
        bytes.extend((payload.len() as u64).to_le_bytes());
        bytes.extend(payload);
        bytes.extend(CRC.checksum(&bytes).to_le_bytes());
        bytes
    }

    #[test]
    fn what_is_read_is_what_was_written() {
        let bytes = encode(&saved()).unwrap();
        assert_eq!(decode(&bytes), Ok(saved()));
        assert_eq!(&bytes[..12], b"mis-run\n\x01\0\0\0");
        assert_eq!(with_payload(&bytes[HEADER..bytes.len() - 8]), bytes);
    }

    #[test]
    fn payloads_that_are_no_run() {
        let bytes = encode(&saved()).unwrap();
        let payload = &bytes[HEADER..bytes.len() - 8];
        let longer = [payload, &[0, 0]].concat();
        assert_eq!(decode(&with_payload(&longer)), Err("there are 2 bytes too many".into()));
        for short in [&payload[..payload.len() - 1], &[]] {
            let error = decode(&with_payload(short)).unwrap_err();
            assert!(error.starts_with("its contents cannot be read: "), "{error}");
        }
    }

    /// The check value of CRC-64/XZ, of the digits 1 to 9.
    #[test]
    fn the_checksum_is_a_known_one() {
        assert_eq!(CRC.checksum(b"123456789"), 0x995d_c9bb_df19_39fa);
        let word = u64::from_le_bytes(*b"12345678");
        assert_eq!(digest([word]), CRC.checksum(b"12345678"));
        assert_ne!(digest([1, 2]), digest([2, 1]));
    }

    #[test]
    fn differences_are_named() {
        let path = Path::new("file");
        let own = saved();
        assert!(own.check(path, &own.identity, own.shard).is_ok());
        let differs = |change: fn(&mut Saved), expected: &str| {
            let mut other = saved();
            change(&mut other);
            let error = own.check(path, &other.identity, other.shard).unwrap_err().to_string();
            assert_eq!(error, format!("checkpoint file: it is of another run: {expected}"));
        };
        differs(|s| s.identity.label = "b".into(), "its label is \"a\", not \"b\"");
        differs(|s| s.identity.components = 1, "its number of components is 2, not 1");
        differs(|s| s.identity.sums = 0, "its number of sums is 3, not 0");
        differs(
            |s| s.identity.estimator = "one-sample".into(),
            "its estimator is \"multi-sample\", not \"one-sample\"",
        );
        differs(
            |s| s.identity.first_samples = 0,
            "its first samples contribute something else: another seed, integrand, technique, \
             weighting, or build",
        );
        differs(|s| s.identity.first_sums = 0, "its sums are of something else");
        differs(|s| s.shard.index = 2, "it is shard 1 of 4, not shard 2 of 4");
    }

    #[test]
    fn the_temporary_file_is_in_the_same_folder() {
        let name = format!("run.ckpt.{}.tmp", std::process::id());
        assert_eq!(beside(Path::new("a/b/run.ckpt")), Path::new("a/b").join(&name));
        assert_eq!(beside(Path::new("run.ckpt")), Path::new(&name));
        assert_eq!(folder_of(Path::new("a/b/run.ckpt")), Path::new("a/b"));
        assert_eq!(folder_of(Path::new("run.ckpt")), Path::new("."));
    }
}
