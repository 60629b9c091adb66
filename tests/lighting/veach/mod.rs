//! Veach's figure as a table: four plates, four lights, every way to combine the two techniques.
//!
//! The shading point is the mirror point of a light on a plate; ρ = 1, no occlusion, one sample of each
//! technique. Variances are relative, V / I². They are integrals over the light's cone, computed by
//! quadrature over the crate's own densities and integrand, and then measured: with the estimators, and
//! with the renderer.

mod measured;
mod optimal;
mod quadrature;

use std::f64::consts::TAU;

use crate::common::quadrature::gauss;
use mis::lighting::{
    Bsdf, DVec3, Direction, Light, Lobe, ModifiedPhong, ReflectedRadiance, Scene, SeenLight,
    Sphere, Surface,
};
use mis::weighting::{Balance, Maximum, Power, Weighting, weights};
use mis::{Integrand, Technique};

pub(crate) const EYE: DVec3 = DVec3::new(0.0, 2.0, 15.0);

/// x of the centre, radius, radiance.
pub(crate) const LIGHTS: [(f64, f64, f64); 4] =
    [(-3.75, 0.03333, 901.803), (-1.25, 0.1, 100.0), (1.25, 0.3, 11.1111), (3.75, 0.9, 1.23457)];

/// The lower and the upper edge as (y, z), and the exponent.
pub(crate) const PLATES: [([f64; 2], [f64; 2], f64); 4] = [
    ([-2.70651, 0.25609], [-2.08375, -0.526_323], 30_000.0),
    ([-3.28825, 1.36972], [-2.83856, 0.476_536], 5000.0),
    ([-3.73096, 2.70046], [-3.43378, 1.74564], 1500.0),
    ([-3.99615, 4.0667], [-3.82069, 3.08221], 100.0),
];

/// How the two techniques are combined, in the order of [`TABLE`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Light,
    Bsdf,
    /// Constant weights of 1/2.
    Constant,
    /// Constant weights, as the inverse variances.
    InverseVariance,
    Balance,
    /// β = 2.
    Power,
    Maximum,
    /// Two samples, each of either technique with probability 1/2.
    OneSample,
    Optimal,
}

const WAYS: [Way; 9] = [
    Way::Light,
    Way::Bsdf,
    Way::Constant,
    Way::InverseVariance,
    Way::Balance,
    Way::Power,
    Way::Maximum,
    Way::OneSample,
    Way::Optimal,
];

/// I, then the relative variance of every way, for each light on each plate.
#[rustfmt::skip]
#[allow(clippy::unreadable_literal)] // as printed
const TABLE: [[[f64; 10]; 4]; 4] = [
    [
        [676.05, 0.57292, 0.066340, 0.15982, 0.059456, 0.082289, 0.10702, 0.35972, 0.087476, 0.054587],
        [81.432, 11.978, 1.6935e-5, 2.9944, 1.6935e-5, 0.094716, 0.042536, 0.054833, 0.37310, 1.2427e-5],
        [9.0480, 116.21, 1.6935e-5, 29.052, 1.6935e-5, 0.022228, 0.0054099, 0.0063778, 0.47672, 1.5741e-5],
        [0.98689, 1048.2, 1.8831e-5, 262.06, 1.8831e-5, 0.0036371, 6.3004e-4, 7.3289e-4, 0.49637, 1.8554e-5],
    ],
    [
        [146.85, 0.0056625, 3.3638, 0.84237, 0.0056529, 0.12084, 0.012986, 0.0056625, 0.31662, 0.0046004],
        [66.022, 0.45048, 0.096433, 0.13673, 0.079429, 0.080702, 0.10634, 0.40128, 0.082678, 0.069065],
        [8.0416, 9.9689, 1.8182e-4, 2.4923, 1.8182e-4, 0.10217, 0.049016, 0.064353, 0.35738, 1.2904e-4],
        [0.87712, 95.796, 1.9622e-4, 23.949, 1.9622e-4, 0.025924, 0.0066934, 0.0078782, 0.47298, 1.8051e-4],
    ],
    [
        [25.447, 1.8979e-4, 21.734, 5.4335, 1.8979e-4, 0.038765, 2.6897e-4, 1.8979e-4, 0.45803, 1.8180e-4],
        [22.423, 0.014845, 1.9145, 0.48234, 0.014730, 0.13313, 0.031615, 0.014845, 0.25067, 0.010992],
        [7.0929, 0.98340, 0.023919, 0.25183, 0.023351, 0.093891, 0.10861, 0.28010, 0.11362, 0.022508],
        [0.79145, 15.608, 9.5529e-4, 3.9022, 9.5523e-4, 0.084518, 0.035165, 0.044148, 0.39452, 7.3250e-4],
    ],
    [
        [1.0392, 1.7576e-5, 520.87, 130.22, 1.7576e-5, 0.0019228, 1.7583e-5, 1.7576e-5, 0.49810, 1.7542e-5],
        [1.0880, 1.7822e-4, 55.313, 13.828, 1.7822e-4, 0.017017, 1.8358e-4, 1.7822e-4, 0.48272, 1.7512e-4],
        [1.0144, 0.0034760, 5.7139, 1.4294, 0.0034739, 0.098984, 0.0059171, 0.0034760, 0.37279, 0.0030277],
        [0.55966, 0.17060, 0.33256, 0.12579, 0.11276, 0.098876, 0.10452, 0.54007, 0.10329, 0.077386],
    ],
];

/// One plate, one light.
pub(crate) struct Cell {
    pub(crate) surface: Surface,
    incident: mis::lighting::Incident<f64>,
    bsdf: ModifiedPhong<f64>,
}

impl Cell {
    pub(crate) fn new(plate: usize, light: usize) -> Self {
        let (lower, upper, exponent) = PLATES[plate];
        let (x, radius, radiance) = LIGHTS[light];
        let edge = DVec3::new(0.0, upper[0] - lower[0], upper[1] - lower[1]);
        let normal = Direction::new(DVec3::X.cross(edge)).unwrap();
        let corner = DVec3::new(0.0, lower[0], lower[1]);
        let centre = DVec3::new(x, 0.0, 0.0);
        let height = |v: DVec3| (v - corner).dot(normal.vector());
        assert!(height(EYE) > 0.0 && height(centre) > 0.0);
        let mirrored = centre - 2.0 * height(centre) * normal.vector();
        let position = EYE.lerp(mirrored, height(EYE) / (height(EYE) + height(centre)));
        let outgoing = Direction::new(EYE - position).unwrap();
        let light = Light::new(Sphere::new(centre, radius).unwrap(), radiance).unwrap();
        Self {
            surface: Surface::new(position, normal, outgoing).unwrap(),
            incident: Scene::new().light(light).seen_from(position).unwrap(),
            bsdf: ModifiedPhong::new(1.0, exponent).unwrap(),
        }
    }

    pub(crate) fn integrand(&self) -> ReflectedRadiance<'_, ModifiedPhong<f64>> {
        ReflectedRadiance::new(&self.incident, self.surface, &self.bsdf)
    }

    pub(crate) fn light(&self) -> &SeenLight<f64> {
        &self.incident.lights()[0]
    }

    pub(crate) fn lobe(&self) -> Lobe<'_, ModifiedPhong<f64>> {
        self.bsdf.techniques(&self.surface).remove(0)
    }

    /// The u at which the samples \[u, ·\] of the light have the same density from the BSDF.
    fn crossing(&self, exponent: f64) -> f64 {
        let ln_ratio = (self.light().directions().value() * (exponent + 1.0) / TAU).ln();
        let width = self.light().directions().value() / TAU;
        -(-ln_ratio / exponent).exp_m1() / width
    }

    /// Nodes in the light's cone, dense towards its axis, where the lobe has its own.
    fn nodes(&self, exponent: f64) -> Vec<Node> {
        const SECTORS: usize = 4;
        let (f, light, lobe) = (self.integrand(), self.light(), self.lobe());
        // The maximum heuristic has a step where the densities are the same.
        let mut ends: Vec<f64> = (0..44).map(|k| 2f64.powi(-k)).collect();
        ends.extend([0.0, self.crossing(exponent).clamp(0.0, 1.0)]);
        ends.sort_by(f64::total_cmp);
        let mut nodes = Vec::new();
        for pair in ends.windows(2) {
            let (low, width) = (pair[0], pair[1] - pair[0]);
            for &(u, wu) in &gauss(4) {
                for sector in 0..SECTORS {
                    let turn = (sector as f64 + 0.25) / SECTORS as f64;
                    let w = light.sample(&[low + u * width, turn]);
                    let weight = wu * width / SECTORS as f64 * light.directions().value();
                    nodes.push(Node { weight, f: f.eval(&w), p: [light.pdf(&w), lobe.pdf(&w)] });
                }
            }
        }
        nodes
    }
}

struct Node {
    weight: f64,
    f: f64,
    p: [f64; 2],
}

/// The variance of an estimate from one sample of each technique, and its fourth central moment.
#[derive(Debug, Clone, Copy)]
struct Moments {
    variance: f64,
    fourth: f64,
}

impl Moments {
    /// Of the sum of two independent ones.
    fn plus(self, other: Self) -> Self {
        let fourth = self.fourth + other.fourth + 6.0 * self.variance * other.variance;
        Self { variance: self.variance + other.variance, fourth }
    }

    fn times(self, factor: f64) -> Self {
        Self { variance: self.variance * factor.powi(2), fourth: self.fourth * factor.powi(4) }
    }
}

/// Of w f / p, with one sample of technique `i`.
fn moments(nodes: &[Node], i: usize, weight: impl Fn(&Node) -> f64) -> Moments {
    let contribution = |node: &Node| {
        let wf = weight(node) * node.f;
        if wf == 0.0 { 0.0 } else { wf / node.p[i] }
    };
    let mean =
        |g: &dyn Fn(&Node) -> f64| nodes.iter().map(|n| n.weight * n.p[i] * g(n)).sum::<f64>();
    let mu = mean(&contribution);
    let missing = (1.0 - mean(&|_| 1.0)).max(0.0);
    let central = |k: i32| mean(&|n| (contribution(n) - mu).powi(k)) + missing * mu.powi(k);
    Moments { variance: central(2), fourth: central(4) }
}

fn integral(nodes: &[Node]) -> f64 {
    nodes.iter().map(|n| n.weight * n.f).sum()
}

/// Of both techniques, one sample each.
fn weighted(nodes: &[Node], weighting: &impl Weighting) -> Moments {
    let weight = |i: usize| move |node: &Node| weights(weighting, &node.p).map_or(0.0, |w| w[i]);
    moments(nodes, 0, weight(0)).plus(moments(nodes, 1, weight(1)))
}

/// Of 2 f / c, c = p_light + p_bsdf, with one sample of c / 2.
fn of_the_mixture(nodes: &[Node]) -> Moments {
    let c = |n: &Node| 0.5 * (n.p[0] + n.p[1]);
    let mu = integral(nodes);
    let inside: f64 = nodes.iter().map(|n| n.weight * c(n)).sum();
    let central = |k: i32| {
        let sum: f64 = nodes.iter().map(|n| n.weight * c(n) * (n.f / c(n) - mu).powi(k)).sum();
        sum + (1.0 - inside).max(0.0) * mu.powi(k)
    };
    Moments { variance: central(2), fourth: central(4) }
}

/// The moments of a way; the fourth is not known for optimal weights.
fn of_way(nodes: &[Node], way: Way) -> Moments {
    let [light, bsdf] = [0, 1].map(|i| moments(nodes, i, |_| 1.0));
    match way {
        Way::Light => light,
        Way::Bsdf => bsdf,
        Way::Constant => light.times(0.5).plus(bsdf.times(0.5)),
        Way::InverseVariance => {
            let part = bsdf.variance / (light.variance + bsdf.variance);
            light.times(part).plus(bsdf.times(1.0 - part))
        }
        Way::Balance => weighted(nodes, &Balance),
        Way::Power => weighted(nodes, &Power::squared()),
        Way::Maximum => weighted(nodes, &Maximum),
        Way::OneSample => {
            let half = of_the_mixture(nodes).times(0.5);
            half.plus(half)
        }
        Way::Optimal => Moments { variance: optimal::optimal(nodes).2, fourth: f64::NAN },
    }
}
