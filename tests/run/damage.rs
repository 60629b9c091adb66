//! Files that are damaged: flipped, cut, joined, or of another version.

use std::fs;
use std::path::PathBuf;

use mis::{Run, Target};

use crate::common::{Case, Dice, Folder, cases, sobol, tally};

struct Damaged<'a> {
    case: &'a Case,
    path: PathBuf,
    sound: Vec<u8>,
}

impl Damaged<'_> {
    fn refused(&self, bytes: &[u8]) -> String {
        assert!(bytes != self.sound);
        fs::write(&self.path, bytes).unwrap();
        let outcome = self.case.go(self.case.run().checkpoint(&self.path));
        let error = outcome.error.expect("a damaged file was continued");
        assert_eq!((outcome.samples, outcome.numbers.as_str()), (0, ""));
        assert!(error.contains("damaged.run"), "{error}");
        assert_eq!(fs::read(&self.path).unwrap(), bytes, "the file was overwritten");
        error
    }
}

/// All bits of `step` apart, as many truncations, and `random` other kinds of damage.
fn corrupted(step: usize, random: u64) -> u64 {
    let folder = Folder::new();
    let case = tally("tally", sobol);
    // Interrupted within a round, with a cut chunk in another.
    let path = folder.file("damaged.run");
    let target = Target::new().samples(1100).unwrap();
    assert_eq!(case.go(Run::new(target).checkpoint(&path)).error, None);
    let sound = fs::read(&path).unwrap();
    let damaged = Damaged { case: &case, path, sound: sound.clone() };
    let mut cases = 0;
    let mut refused = |bytes: &[u8]| {
        cases += 1;
        damaged.refused(bytes)
    };

    // The header, each bit; the rest, one of `step`.
    let bits = (0..8 * 40).chain((8 * 40..8 * sound.len()).step_by(step));
    for bit in bits {
        let mut bytes = sound.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let text = refused(&bytes);
        let expected = match bit / 8 {
            0..8 => "does not begin like a checkpoint",
            8..12 => "its format is version",
            12..20 => "it was cut or joined",
            _ => "its checksum does not match",
        };
        assert!(text.contains(expected), "{bit}: {text}");
    }
    for length in (0..40).chain((40..sound.len()).step_by(step)).chain([sound.len() - 1]) {
        let text = refused(&sound[..length]);
        let expected = match length {
            0..8 => format!("it has {length} bytes"),
            8..28 => format!("it ends after {length} bytes"),
            _ => "it was cut or joined".into(),
        };
        assert!(text.contains(&expected), "{length}: {text}");
        // The same, filled up with zeros, as after a crash.
        let mut bytes = sound[..length].to_vec();
        bytes.resize(sound.len(), 0);
        refused(&bytes);
    }
    let half = sound.len() / 2;
    refused(&[&sound[half..], &sound[..half]].concat());
    refused(&[&sound[..20], &sound[half..], &sound[20..half]].concat());
    refused(&[&sound[..], &sound[..]].concat());
    refused(&[&sound[..], &[0]].concat());
    refused(&[&sound[1..], &[0]].concat());
    refused(b"mis-run\n");
    refused("{\"samples\": 3}".as_bytes());
    refused(&vec![0; sound.len()]);
    refused(&vec![0xff; sound.len()]);

    let mut dice = Dice(11);
    for number in 0..random {
        let mut bytes = sound.clone();
        let at = |dice: &mut Dice| usize::try_from(dice.below(sound.len() as u64)).unwrap();
        match number % 4 {
            0 => {
                for _ in 0..2 + dice.below(20) {
                    let at = at(&mut dice);
                    bytes[at] ^= 1 + u8::try_from(dice.below(255)).unwrap();
                }
            }
            1 => {
                // A sector of something else.
                let (start, length) = (at(&mut dice), at(&mut dice).min(512) + 1);
                for byte in bytes.iter_mut().skip(start).take(length) {
                    *byte = u8::try_from(dice.below(256)).unwrap();
                }
            }
            2 => {
                let (a, b) = (at(&mut dice), at(&mut dice));
                bytes.swap(a, b);
            }
            _ => {
                for _ in 0..=dice.below(64) {
                    let byte = u8::try_from(dice.below(256)).unwrap();
                    bytes.insert(at(&mut dice), byte);
                }
            }
        }
        if bytes != sound {
            refused(&bytes);
        }
    }
    // What was not damaged is still good.
    fs::write(&damaged.path, &sound).unwrap();
    assert_eq!(case.go(case.run().checkpoint(&damaged.path)), case.whole());
    cases
}

#[test]
fn damaged_files_are_refused() {
    let cases = corrupted(31, 8000);
    assert!(cases > 10_000, "{cases}");
}

/// A file with a correct checksum, but of a version that this build does not know.
#[test]
fn another_version() {
    let folder = Folder::new();
    let case = &cases()[0];
    let path = folder.file("damaged.run");
    case.go(case.run().checkpoint(&path));
    let sound = fs::read(&path).unwrap();
    let crc = crc::Crc::<u64>::new(&crc::CRC_64_XZ);
    let with_version = |version: u32| {
        let mut bytes = sound[..sound.len() - 8].to_vec();
        bytes[8..12].copy_from_slice(&version.to_le_bytes());
        let checksum = crc.checksum(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    };
    let damaged = Damaged { case, path, sound: sound.clone() };
    let version = u32::from_le_bytes(sound[8..12].try_into().unwrap());
    assert_eq!(with_version(version), sound);
    for other in [0, version + 1, u32::MAX] {
        let text = damaged.refused(&with_version(other));
        assert!(
            text.contains(&format!("is version {other}; this build reads {version}")),
            "{text}"
        );
    }
}
