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
            _ => format!(
                "it should hold {} bytes and holds {}: it was cut or joined",
                sound.len() - 28,
                length - 28
            ),
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
    let cases = corrupted(31, 3000);
    assert!(cases > 5000, "{cases}");
}

/// The file with what lies between its header and its checksum changed, and both corrected.
fn with_payload(sound: &[u8], change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut payload = sound[20..sound.len() - 8].to_vec();
    change(&mut payload);
    let mut bytes = sound[..12].to_vec();
    bytes.extend((payload.len() as u64).to_le_bytes());
    bytes.extend(payload);
    let checksum = crc::Crc::<u64>::new(&crc::CRC_64_XZ).checksum(&bytes);
    bytes.extend(checksum.to_le_bytes());
    bytes
}

/// What tells a run from others, its shard and its limit.
type Head = ((String, usize, usize, u64, u64, String), (u64, u64), u64);

/// Where the rounds begin in a payload.
fn rounds_of(payload: &[u8]) -> usize {
    let (_, rounds) = postcard::take_from_bytes::<Head>(payload).unwrap();
    payload.len() - rounds.len()
}

/// With a correct checksum, as of a build with an error.
#[test]
fn rounds_of_another_estimator() {
    let folder = Folder::new();
    let cases = cases();
    let case = |name: &str| cases.iter().find(|case| case.name == name).unwrap();
    for (own, other, text) in [
        ("tally", "multi-sample", "3 contributions where there should be 2"),
        ("vector, power", "multi-sample", "3 contributions where there should be 6"),
        ("tally", "one-sample", "0 sums of a tally where there should be 5"),
        ("one-sample", "tally", "5 sums of a tally where there should be 0"),
    ] {
        // Alone, and as the second of two shards.
        for of in [1, 2] {
            let file = |name: &str| {
                let path = folder.file(&format!("{name} of {of} damaged.run"));
                fs::remove_file(&path).ok();
                let run = case(name).run().checkpoint(&path).shard(of - 1, of).unwrap();
                assert_eq!(case(name).go(run).error, None);
                (fs::read(&path).unwrap(), path)
            };
            let ((sound, path), (donor, _)) = (file(own), file(other));
            let donor = &donor[20..donor.len() - 8];
            let bytes = with_payload(&sound, |payload| {
                payload.truncate(rounds_of(payload));
                payload.extend(&donor[rounds_of(donor)..]);
            });
            let case = case(own);
            let error = if of == 1 {
                Damaged { case, path, sound }.refused(&bytes)
            } else {
                fs::write(&path, &bytes).unwrap();
                let first = folder.file("first");
                let run = case.run().checkpoint(&first).shard(0, 2).unwrap();
                fs::remove_file(&first).ok();
                assert_eq!(case.go(run).error, None);
                case.merge(case.run(), &[first, path]).error.unwrap()
            };
            assert!(error.ends_with(&format!("damaged.run: its round 0 has {text}")), "{error}");
        }
    }
}

/// Shards that hold a part that is not theirs, or of which there are more than they say.
#[test]
fn shards_of_another_division() {
    let folder = Folder::new();
    let case = &cases()[0];
    let draw = |of: u64| -> Vec<PathBuf> {
        let path = |index| folder.file(&format!("{index} of {of} damaged.run"));
        let shard = |index| case.run().checkpoint(path(index)).shard(index, of).unwrap();
        (0..of).for_each(|index| assert_eq!(case.go(shard(index)).error, None));
        (0..of).map(path).collect()
    };
    let merged = |files: &[PathBuf]| case.merge(case.run(), files).error.unwrap();
    // Of 90, most have none of the 16 chunks of the first round.
    let files = draw(90);
    let donor = fs::read(&files[89]).unwrap();
    let donor = &donor[20..donor.len() - 8];
    let bytes = with_payload(&fs::read(&files[1]).unwrap(), |payload| {
        payload.truncate(rounds_of(payload));
        payload.extend(&donor[rounds_of(donor)..]);
    });
    fs::write(&files[1], bytes).unwrap();
    let error = merged(&files);
    assert!(error.ends_with("1 of 90 damaged.run has more of round 0 than its part"), "{error}");

    let files = draw(3);
    for path in &files {
        let bytes = with_payload(&fs::read(path).unwrap(), |payload| {
            let rounds = payload.split_off(rounds_of(payload));
            let (mut head, _) = postcard::take_from_bytes::<Head>(payload).unwrap();
            head.1.1 = 2;
            *payload = postcard::to_stdvec(&head).unwrap();
            payload.extend(rounds);
        });
        fs::write(path, bytes).unwrap();
    }
    let error = merged(&files);
    assert!(error.ends_with("2 of 3 damaged.run is shard 2 of 2"), "{error}");
}

/// Whatever a file with a correct checksum holds: it is refused or continued, without a panic.
#[test]
fn damage_below_the_checksum() {
    let folder = Folder::new();
    let case = tally("tally", sobol);
    let path = folder.file("damaged.run");
    let target = Target::new().samples(1100).unwrap();
    assert_eq!(case.go(Run::new(target).checkpoint(&path)).error, None);
    let sound = fs::read(&path).unwrap();
    assert_eq!(with_payload(&sound, |_| ()), sound);
    let start = rounds_of(&sound[20..sound.len() - 8]);
    let mut refused = std::collections::BTreeMap::new();
    let mut go = |change: &dyn Fn(&mut Vec<u8>)| {
        fs::write(&path, with_payload(&sound, change)).unwrap();
        let outcome = case.go(case.run().checkpoint(&path));
        if let Some(error) = outcome.error {
            let problem: String = error.chars().filter(|c| !c.is_ascii_digit()).collect();
            *refused.entry(problem).or_insert(0) += 1;
        }
    };
    let (mut dice, mut cases) = (Dice(5), 0);
    for (at, byte) in sound.iter().skip(20 + start).take(sound.len() - 28 - start).enumerate() {
        // Small ones are lengths, indices and counts; most of the others are digits of sums.
        if *byte > 0 && *byte < 20 || dice.below(50) == 0 {
            let at = start + at;
            go(&|payload| payload[at] = byte.wrapping_add(1));
            go(&|payload| payload[at] = byte.wrapping_sub(1));
            // The largest of all numbers, as postcard writes them.
            go(&|payload| drop(payload.splice(at..=at, [[0xff; 9].as_slice(), &[1]].concat())));
            cases += 3;
        }
    }
    assert!(cases > 1000, "{cases}");
    // Flipped digits of sums cannot be told; of counts and lengths they can.
    let has = |text: &str| refused.keys().any(|problem| problem.contains(text));
    for text in ["cannot be read", "contradict", "follow one another", "as chunk", "should be"] {
        assert!(has(text), "{text}: {refused:#?}");
    }
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
