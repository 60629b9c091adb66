//! The bits of a run depend on its inputs and seed alone.

use mis::technique::{Linear, Uniform};
use mis::{MultiSample, Report, Run, Stop, Target};

use crate::common::{SEED, cases, f};

#[test]
fn threads_do_not_change_a_bit() {
    for case in cases() {
        let one = case.whole();
        assert!(one.numbers.contains("moments: Moments") && one.all.contains("k-hat"));
        for threads in [2, 3, 8] {
            let run = Run::new(case.target).threads(threads).unwrap();
            assert_eq!(case.go(run), one, "{case:?}, {threads} threads");
        }
        assert_eq!(case.go(Run::new(case.target)), one, "{case:?}, all threads");
    }
}

#[test]
fn the_cases_are_of_several_rounds_with_a_cut_at_the_end() {
    for case in cases() {
        let whole = case.whole();
        let converges = case.name.starts_with("tolerance");
        assert_eq!(whole.stop == Stop::Tolerance, converges, "{case:?}");
        assert!(whole.samples > 1024);
        // Chunks of the second and third rounds have 64 and 128 samples.
        assert_eq!(
            whole.samples % 64 == 0,
            converges || case.name.starts_with("one-sample"),
            "{case:?}"
        );
    }
}

#[test]
fn another_seed_has_other_bits() {
    for case in cases() {
        let (one, other) = (case.whole(), case.seeded(case.run(), SEED + 1));
        assert_ne!(one.numbers, other.numbers);
    }
}

/// Value, error, κ, k̂, the largest contribution, a density score and a sum of a run, which are the
/// same in every build.
#[test]
fn golden_values() {
    let flat = Uniform::new(0.0, 2.0).unwrap();
    let ramp = Linear::new(0.0, 2.0, 0.0, 1.0).unwrap();
    let mis = MultiSample::new(&[(&flat, 3), (&ramp, 1)]).unwrap();
    let run = Run::new(Target::new().samples(20_000).unwrap());
    let points = mis::points::Random::new(1);
    let report: Report = run
        .tally(&mis, &f, &points, 1, |sample, tally| {
            tally.add(0, sample.x() * sample.contribution());
        })
        .unwrap();
    let found = [
        report.value(),
        report.standard_error().unwrap(),
        report.estimate().kappa().unwrap(),
        report.estimate().largest().unwrap().contribution,
        report.density_scores()[1].unwrap(),
        report.tallied()[0].value,
        report.tallied()[0].standard_error.unwrap(),
        report.rounds()[3].cumulative.value(),
    ]
    .map(f64::to_bits);
    let golden = [
        0x3feb_c38e_13ea_e504,
        0x3f60_22ea_8e22_5970,
        0x3f57_b5eb_dcbb_b3ae,
        0x3f10_f7ea_8b4a_2a11,
        0x3ff7_a1aa_b3d0_3097,
        0x3fea_5edc_343a_21c8,
        0x3f5f_e921_472b_b2ca,
        0x3feb_b859_f1ea_6f84,
    ];
    assert_eq!(found, golden, "{found:#x?}");
    // Of logarithms and exponentials, so the same on this platform only.
    assert!(report.k_hat().is_some());
}
