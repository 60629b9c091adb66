//! Densities, CDFs and inverses against values computed with mpmath to 400 digits and more.

// Golden values are printed as they were computed; the table is one list.
#![allow(clippy::excessive_precision, clippy::unreadable_literal, clippy::approx_constant)]
#![allow(clippy::unwrap_used, clippy::too_many_lines)]

use mis::technique::{Cauchy, InverseCdf, Normal, TruncatedCauchy, TruncatedNormal};

const INF: f64 = f64::INFINITY;

type Boxed = Box<dyn InverseCdf>;

fn normal(mean: f64, sd: f64) -> Boxed {
    Box::new(Normal::new(mean, sd).unwrap())
}

fn truncated_normal(mean: f64, sd: f64, a: f64, b: f64) -> Boxed {
    Box::new(TruncatedNormal::new(mean, sd, a, b).unwrap())
}

fn cauchy(location: f64, scale: f64) -> Boxed {
    Box::new(Cauchy::new(location, scale).unwrap())
}

fn truncated_cauchy(location: f64, scale: f64, a: f64, b: f64) -> Boxed {
    Box::new(TruncatedCauchy::new(location, scale, a, b).unwrap())
}

/// `found` to 1e-14, or to the rounding of an exponent -z²/2 = ln `expected`.
fn close(found: f64, expected: f64) -> bool {
    let tolerance = 1e-14_f64.max(4.0 * f64::EPSILON * expected.ln().abs());
    found == expected || (found - expected).abs() <= tolerance * expected.abs()
}

#[test]
fn densities_and_masses() {
    for (p, x, pdf, cdf, survival) in [
        (normal(1.0, 2.0), -50.0, 1.2585968525967024e-142, 9.856236518963929e-144, 1.0),
        (normal(1.0, 2.0), -3.5, 0.01586982591783371, 0.012224472655044703, 0.9877755273449553),
        (normal(1.0, 2.0), 1.0, 0.19947114020071635, 0.5, 0.5),
        (normal(1.0, 2.0), 2.25, 0.1640804842751875, 0.7340144709512995, 0.26598552904870054),
        (normal(1.0, 2.0), 30.0, 4.412377487297411e-47, 1.0, 6.057494764415221e-48),
        (
            truncated_normal(0.0, 1.0, -1.0, 2.0),
            -0.9,
            0.32505130782552455,
            0.03103474048946891,
            0.9689652595105311,
        ),
        (
            truncated_normal(0.0, 1.0, -1.0, 2.0),
            0.1,
            0.4849195690147126,
            0.4656426719288498,
            0.5343573280711502,
        ),
        (
            truncated_normal(0.0, 1.0, -1.0, 2.0),
            1.9,
            0.08015666563502291,
            0.992711376589945,
            0.00728862341005497,
        ),
        (truncated_normal(0.0, 1.0, 100.0, 101.0), 100.0, 100.00999800099926, 0.0, 1.0),
        (
            truncated_normal(0.0, 1.0, 100.0, 101.0),
            100.0078125,
            45.78651628066102,
            0.5422163671778765,
            0.4577836328221235,
        ),
        (
            truncated_normal(0.0, 1.0, 100.0, 101.0),
            100.5,
            1.702285944240029e-20,
            1.0,
            1.6936492092378836e-22,
        ),
        (
            truncated_normal(0.0, 1.0, 38.0, INF),
            38.015625,
            20.997542672954204,
            0.44804160273218147,
            0.5519583972678186,
        ),
        (
            truncated_normal(0.0, 1.0, 38.0, INF),
            39.0,
            7.240128635110092e-16,
            1.0,
            1.8552250980243833e-17,
        ),
        (
            truncated_normal(-5.0, 1.0, 0.0, INF),
            1e-20,
            5.186503967125842,
            5.1865039671258416e-20,
            1.0,
        ),
        (
            truncated_normal(-5.0, 1.0, 0.0, INF),
            0.125,
            2.7545314644294487,
            0.4810114864799581,
            0.5189885135200418,
        ),
        (
            truncated_normal(-5.0, 1.0, 0.0, INF),
            2.0,
            3.1866981745400364e-05,
            0.9999955353025435,
            4.464697456552576e-06,
        ),
        (
            truncated_normal(0.0, 1.0, 3.0, 4.0),
            3.125,
            2.292669257362177,
            0.34961566256185955,
            0.6503843374381404,
        ),
        (
            truncated_normal(0.0, 1.0, 3.0, 4.0),
            3.5,
            0.6620125624818818,
            0.8475544278436676,
            0.1524455721563324,
        ),
        (
            cauchy(91.1875, 1.25),
            -1000000000.0,
            3.978872851650414e-19,
            3.9788732144738824e-10,
            0.9999999996021127,
        ),
        (cauchy(91.1875, 1.25), 91.0, 0.24904440972814917, 0.45260685772251036, 0.5473931422774896),
        (cauchy(91.1875, 1.25), 92.5, 0.12111672244805352, 0.7577621168183132, 0.2422378831816868),
        (
            cauchy(91.1875, 1.25),
            100000.0,
            3.986139984932832e-11,
            0.9999960174948761,
            3.9825051239496735e-06,
        ),
        (
            truncated_cauchy(91.1875, 1.25, 60.0, 120.0),
            60.5,
            0.0004333156455079866,
            0.00021318998196252187,
            0.9997868100180375,
        ),
        (
            truncated_cauchy(91.1875, 1.25, 60.0, 120.0),
            91.0,
            0.25583739704868974,
            0.4518533692566753,
            0.5481466307433247,
        ),
        (
            truncated_cauchy(91.1875, 1.25, 60.0, 120.0),
            110.0,
            0.0011498499510215724,
            0.9924821567631843,
            0.0075178432368157334,
        ),
        (
            truncated_cauchy(0.0, 1.0, 1e9, 1000000001.0),
            1000000000.25,
            1.0000000005,
            0.2500000001875,
            0.7499999998125,
        ),
        (
            truncated_cauchy(-1e9, 1.0, 0.0, 0.001),
            0.00025,
            1000.0000000005,
            0.2500000000001875,
            0.7499999999998125,
        ),
    ] {
        assert!(close(p.pdf(&x), pdf), "pdf({x}) = {:e}, not {pdf:e}", p.pdf(&x));
        assert!(close(p.cdf(x), cdf), "cdf({x}) = {:e}, not {cdf:e}", p.cdf(x));
        let found = p.survival(x);
        assert!(close(found, survival), "survival({x}) = {found:e}, not {survival:e}");
    }
}

#[test]
fn inverses() {
    for (p, u, x) in [
        (normal(1.0, 2.0), 1e-300, -73.0941925987224),
        (normal(1.0, 2.0), 1e-20, -17.524680179596814),
        (normal(1.0, 2.0), 0.003, -4.495562770889985),
        (normal(1.0, 2.0), 0.4, 0.4933057937284005),
        (normal(1.0, 2.0), 0.9, 3.563103131089201),
        (truncated_normal(0.0, 1.0, -1.0, 2.0), 1e-09, -0.9999999966169684),
        (truncated_normal(0.0, 1.0, -1.0, 2.0), 0.3, -0.24240381788922682),
        (truncated_normal(0.0, 1.0, -1.0, 2.0), 0.9, 1.2557153641502152),
        (cauchy(91.1875, 1.25), 1e-10, -3978873486.1098833),
        (cauchy(91.1875, 1.25), 0.1, 87.34039557853093),
        (cauchy(91.1875, 1.25), 0.45, 90.98951944959433),
        (cauchy(91.1875, 1.25), 0.99, 130.9631449422174),
        (truncated_cauchy(91.1875, 1.25, 60.0, 120.0), 0.001, 62.214512616056794),
        (truncated_cauchy(91.1875, 1.25, 60.0, 120.0), 0.45, 90.9927494329789),
        (truncated_cauchy(91.1875, 1.25, 60.0, 120.0), 0.99, 108.06261588087628),
    ] {
        let found = p.inverse_cdf(u);
        assert!((found - x).abs() <= 1e-14 * x.abs(), "inverse_cdf({u:e}) = {found}, not {x}");
    }
}
