//! What is counted of the library; each function takes how much of it to do.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Debug;

use mis::integrand::batch;
use mis::lighting::{
    Bsdf, DVec3, Direction, Lambert, Light, ModifiedPhong, ReflectedRadiance, Renderer, Scene,
    Sphere, Surface,
};
use mis::points::{PointSource, Random, Sobol};
use mis::technique::{Exponential, FnTechnique, Linear, Product, UniformBox, canonical};
use mis::weighting::{Constant, Power, Weighting};
use mis::{Estimate, EstimateError, Estimator, Integrand, MultiSample, OneSample, Run, Target};
use mis::{Technique, integrand};

use super::by_hand;
use super::scene::{camera, scene};

fn finish(estimate: Result<Estimate, EstimateError>) -> f64 {
    let estimate = estimate.unwrap();
    estimate.value() + estimate.standard_error().unwrap()
}

fn cosine() -> impl Technique<Point = f64> {
    FnTechnique::new([0.0, FRAC_PI_2], f64::cos, f64::sin, f64::asin).unwrap()
}

fn sine() -> impl Technique<Point = f64> {
    let inverse = |u: f64| 2.0 * (u / 2.0).sqrt().asin();
    FnTechnique::new([0.0, FRAC_PI_2], f64::sin, |x: f64| 1.0 - x.cos(), inverse).unwrap()
}

fn sin_cos(x: &f64) -> f64 {
    x.sin() * x.cos()
}

pub(crate) fn balance(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    finish(MultiSample::new(&[(&cosine, n / 2), (&sine, n / 2)]).unwrap().estimate(&sin_cos, 1))
}

fn weighted(n: u64, weighting: impl Weighting) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    let mis = MultiSample::new(&[(&cosine, n / 2), (&sine, n / 2)]).unwrap();
    finish(mis.weighting(weighting).unwrap().estimate(&sin_cos, 1))
}

pub(crate) fn power(n: u64) -> f64 {
    weighted(n, Power::squared())
}

pub(crate) fn constant(n: u64) -> f64 {
    weighted(n, Constant::equal())
}

pub(crate) fn one_sample(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    finish(OneSample::new(&[(&cosine, 0.5), (&sine, 0.5)], n).unwrap().estimate(&sin_cos, 1))
}

pub(crate) fn sobol(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    let mis = MultiSample::new(&[(&cosine, n / 2), (&sine, n / 2)]).unwrap();
    finish(mis.estimate_from(&sin_cos, &Sobol::new(1)))
}

/// A point that carries what several evaluations share.
#[derive(Debug, Clone, Copy)]
struct Angle {
    sin: f64,
    cos: f64,
}

/// p = cos (technique 0) or sin (technique 1) over angles.
struct Carried(u64);

impl Technique for Carried {
    type Point = Angle;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> Angle {
        let (sin, cos) = by_hand::sample(self.0, canonical(xi, 0)).sin_cos();
        Angle { sin, cos }
    }

    fn pdf(&self, x: &Angle) -> f64 {
        if self.0 == 0 { x.cos } else { x.sin }
    }
}

pub(crate) fn carried(n: u64) -> f64 {
    let mis = MultiSample::new(&[(&Carried(0), n / 2), (&Carried(1), n / 2)]).unwrap();
    finish(mis.estimate(&|x: &Angle| x.sin * x.cos, 1))
}

/// The same, from algebra alone.
struct Algebraic<const TECHNIQUE: u64>;

impl<const TECHNIQUE: u64> Technique for Algebraic<TECHNIQUE> {
    type Point = Angle;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> Angle {
        let (sin, cos) = by_hand::algebraic(TECHNIQUE, canonical(xi, 0));
        Angle { sin, cos }
    }

    fn pdf(&self, x: &Angle) -> f64 {
        if TECHNIQUE == 0 { x.cos } else { x.sin }
    }
}

pub(crate) fn algebraic(n: u64) -> f64 {
    let mis = MultiSample::new(&[(&Algebraic::<0>, n / 2), (&Algebraic::<1>, n / 2)]).unwrap();
    finish(mis.estimate(&|x: &Angle| x.sin * x.cos, 1))
}

/// The same over sin x, of which all loops become vector instructions.
struct Sine<const TECHNIQUE: u64>;

impl<const TECHNIQUE: u64> Technique for Sine<TECHNIQUE> {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        by_hand::algebraic(TECHNIQUE, canonical(xi, 0)).0
    }

    fn pdf(&self, sin: &f64) -> f64 {
        if TECHNIQUE == 0 { (1.0 - sin * sin).sqrt() } else { *sin }
    }
}

pub(crate) fn in_batches(n: u64) -> f64 {
    let mis = MultiSample::new(&[(&Sine::<0>, n / 2), (&Sine::<1>, n / 2)]).unwrap();
    let f = batch(|xs: &[f64], ys: &mut [f64]| {
        for (y, sin) in ys.iter_mut().zip(xs) {
            *y = sin * (1.0 - sin * sin).sqrt();
        }
    });
    finish(mis.estimate(&f, 1))
}

/// K ramps of different slopes.
fn ramps<const K: usize>(n: u64, weighting: impl Weighting) -> f64 {
    let ramps: [Linear; K] =
        std::array::from_fn(|k| Linear::new(0.0, 1.0, 1.0, 1.5 + k as f64).unwrap());
    let share = n / K as u64;
    let techniques = ramps.each_ref().map(|ramp| (ramp as &dyn Technique<Point = f64>, share));
    let mis = MultiSample::new(&techniques).unwrap().weighting(weighting).unwrap();
    let f = integrand::batch(|xs: &[f64], ys: &mut [f64]| {
        ys.iter_mut().zip(xs).for_each(|(y, x)| *y = 1.0 + x * x);
    });
    finish(mis.estimate(&f, 1))
}

pub(crate) fn ramps_balance<const K: usize>(n: u64) -> f64 {
    ramps::<K>(n, mis::weighting::Balance)
}

pub(crate) fn ramps_constant<const K: usize>(n: u64) -> f64 {
    ramps::<K>(n, Constant::equal())
}

/// The densities of `n` points.
pub(crate) fn ramp_density(n: u64) -> f64 {
    let ramp = Linear::new(0.0, 1.0, 1.0, 1.5).unwrap();
    let ramp: &dyn Technique<Point = f64> = &ramp;
    let xs: Vec<f64> = (0..512).map(|k| f64::from(k) / 512.0).collect();
    let mut out = vec![0.0; 512];
    let mut sum = 0.0;
    for _ in 0..n / 512 {
        ramp.pdf_batch(&xs, &mut out);
        sum += out[17];
    }
    sum
}

pub(crate) fn product(n: u64) -> f64 {
    let cube = UniformBox::uniform([0.0; 8], [1.0; 8]).unwrap();
    let decay = Product::new([Exponential::new(3.0, 0.0, 1.0).unwrap(); 8]).unwrap();
    let mis = MultiSample::new(&[(&cube, n / 2), (&decay, n / 2)]).unwrap();
    let f = |x: &[f64; 8]| (-3.0 * x.iter().sum::<f64>()).exp() * (1.0 + x[0]);
    finish(mis.estimate(&f, 1))
}

/// The radiance of a matte and glossy point under a sphere, by two lobes and the light.
pub(crate) fn lighting(n: u64) -> f64 {
    let sphere = Sphere::new(DVec3::new(1.5, -0.2, 2.0), 0.5).unwrap();
    let scene = Scene::new().light(Light::new(sphere, 4.0).unwrap());
    let normal = Direction::new(DVec3::Z).unwrap();
    let eye = Direction::new(DVec3::new(-1.3, -0.1, 2.0)).unwrap();
    let surface = Surface::new(DVec3::ZERO, normal, eye).unwrap();
    let incident = scene.seen_from(surface.position()).unwrap();
    let bsdf = (Lambert::new(0.5).unwrap(), ModifiedPhong::new(0.5, 300.0).unwrap());
    let f = ReflectedRadiance::new(&incident, surface, &bsdf);
    let lobes = bsdf.techniques(&surface);
    let lights = incident.lights().iter().map(|light| (light as &dyn Technique<Point = _>, n / 3));
    let lobes = lobes.iter().map(|lobe| (lobe as &dyn Technique<Point = _>, n / 3));
    let techniques: Vec<_> = lights.chain(lobes).collect();
    finish(MultiSample::new(&techniques).unwrap().estimate(&f, 1))
}

/// A picture of 32 by 32 pixels, with 32 samples for each ray.
pub(crate) fn rendered(n: u64) -> f64 {
    let (scene, camera) = (scene(), camera(32));
    let renderer = Renderer::new(&scene, &camera).rays(n / (32 * 32 * 32)).unwrap();
    let renderer = renderer.samples(16, 16).unwrap().threads(1).unwrap();
    renderer.render(1).unwrap().mean()
}

/// `n` numbers, in rows of five.
fn points(n: u64, points: &impl PointSource) -> f64 {
    let mut xi = vec![0.0; 512 * 5];
    let mut sum = 0.0;
    for block in 0..n / (512 * 5) {
        points.fill(0, 512 * block, 5, &mut xi).unwrap();
        sum += xi[17];
    }
    sum
}

pub(crate) fn random_points(n: u64) -> f64 {
    points(n, &Random::new(1))
}

pub(crate) fn sobol_points(n: u64) -> f64 {
    points(n, &Sobol::new(1))
}

fn on_one_thread<E: Estimator<P>, P: Debug>(
    estimator: &E,
    f: &(impl Integrand<P, Value = f64> + Sync),
    n: u64,
) -> f64 {
    let target = Target::new().samples(n).unwrap();
    let report = Run::new(target).threads(1).unwrap().execute(estimator, f, 1).unwrap();
    report.value() + report.standard_error().unwrap()
}

pub(crate) fn run_balance(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    on_one_thread(&MultiSample::new(&[(&cosine, 1), (&sine, 1)]).unwrap(), &sin_cos, n)
}

pub(crate) fn run_carried(n: u64) -> f64 {
    let mis = MultiSample::new(&[(&Carried(0), 1), (&Carried(1), 1)]).unwrap();
    on_one_thread(&mis, &|x: &Angle| x.sin * x.cos, n)
}

pub(crate) fn run_constant(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    let mis = MultiSample::new(&[(&cosine, 1), (&sine, 1)]).unwrap();
    on_one_thread(&mis.weighting(Constant::equal()).unwrap(), &sin_cos, n)
}

pub(crate) fn run_one_sample(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    on_one_thread(&OneSample::new(&[(&cosine, 0.5), (&sine, 0.5)], 1).unwrap(), &sin_cos, n)
}

/// A run of 1024 · 2^`rounds` samples, in 16 chunks a round, and the same samples at once.
pub(crate) fn chunks(rounds: u64) -> f64 {
    let one = Linear::new(0.0, 1.0, 1.0, 1.5).unwrap();
    let mis = MultiSample::new(&[(&one, 1)]).unwrap();
    on_one_thread(&mis, &|x: &f64| x * x, 1024 << rounds)
}

pub(crate) fn at_once(rounds: u64) -> f64 {
    let one = Linear::new(0.0, 1.0, 1.0, 1.5).unwrap();
    finish(MultiSample::new(&[(&one, 1024 << rounds)]).unwrap().estimate(&|x: &f64| x * x, 1))
}
