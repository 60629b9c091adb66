//! The slides' pseudocode, line by line, beside the estimators.

use crate::common::canonical_numbers;
use crate::support::{assert_close, direction, horizontal, sphere_light};
use mis::lighting::{
    Bsdf, DVec3, Direction, Incident, Light, Lobe, ModifiedPhong, Rectangle, ReflectedRadiance,
    Scene, SeenLight, Surface,
};
use mis::points::Replay;
use mis::{Estimator, MultiSample, OneSample, Technique};

struct Setting {
    surface: Surface,
    incident: Incident<f64>,
    bsdf: ModifiedPhong<f64>,
}

fn setting() -> Setting {
    let normal = direction(0.0, 0.0, 1.0);
    let surface = Surface::new(DVec3::ZERO, normal, direction(-0.4, 0.0, 1.0)).unwrap();
    let scene = Scene::new()
        .light(sphere_light(DVec3::new(1.0, 0.2, 2.0), 0.6, 3.0))
        .occluder(mis::lighting::Sphere::new(DVec3::new(0.5, 0.3, 1.0), 0.1).unwrap());
    Setting {
        surface,
        incident: scene.seen_from(surface.position()).unwrap(),
        bsdf: ModifiedPhong::new(0.9, 40.0).unwrap(),
    }
}

impl Setting {
    fn light(&self) -> &SeenLight<f64> {
        &self.incident.lights()[0]
    }

    fn lobe(&self) -> Lobe<'_, ModifiedPhong<f64>> {
        self.bsdf.techniques(&self.surface).remove(0)
    }

    /// "Sample the light source", times the given weight of both pdfs.
    fn sample_light(&self, xi: &[f64], weight: impl Fn(f64, f64) -> f64) -> f64 {
        let wi = self.light().sample(xi);
        let light_pdf = self.light().pdf(&wi);
        let li = self.incident.radiance(&wi);
        let bsdf_pdf = self.lobe().pdf(&wi);
        let f = self.bsdf.value(&self.surface, &wi);
        f * li * weight(light_pdf, bsdf_pdf) * wi.cos(self.surface.normal()).max(0.0) / light_pdf
    }

    /// "Sample the BSDF".
    fn sample_bsdf(&self, xi: &[f64], weight: impl Fn(f64, f64) -> f64) -> f64 {
        let wi = self.lobe().sample(xi);
        let f = self.bsdf.value(&self.surface, &wi);
        let bsdf_pdf = self.lobe().pdf(&wi);
        let light_pdf = self.light().pdf(&wi);
        let le = self.incident.radiance(&wi);
        f * le * weight(bsdf_pdf, light_pdf) * wi.cos(self.surface.normal()).max(0.0) / bsdf_pdf
    }
}

#[test]
fn multi_sample_is_the_sum_of_both_samples() {
    let s = setting();
    let xi = canonical_numbers(41, 4000);
    let (for_light, for_bsdf) = xi.split_at(2000);
    let balance = |own: f64, other: f64| own / (own + other);
    let by_hand: f64 = for_light
        .chunks(2)
        .zip(for_bsdf.chunks(2))
        .map(|(u, v)| s.sample_light(u, balance) + s.sample_bsdf(v, balance))
        .sum();
    let lobe = s.lobe();
    let f = ReflectedRadiance::new(&s.incident, s.surface, &s.bsdf);
    let replay = Replay::new([for_light.to_vec(), for_bsdf.to_vec()]).unwrap();
    let mis = MultiSample::new(&[(s.light(), 1000), (&lobe, 1000)]).unwrap();
    let estimate = mis.estimate_from(&f, &replay).unwrap();
    assert!(estimate.value() > 0.1);
    assert_close(estimate.value(), by_hand / 1000.0, 1e-13);
}

#[test]
fn one_sample_selects_a_strategy_for_each_sample() {
    let s = setting();
    let prob_smp_light = 0.3;
    let xi = canonical_numbers(42, 6000);
    let by_hand: f64 = xi
        .chunks(3)
        .map(|xi| {
            if xi[0] < prob_smp_light {
                s.sample_light(&xi[1..], |own, other| own / (own + other)) / prob_smp_light
            } else {
                s.sample_bsdf(&xi[1..], |own, other| own / (own + other)) / (1.0 - prob_smp_light)
            }
        })
        .sum();
    let lobe = s.lobe();
    let f = ReflectedRadiance::new(&s.incident, s.surface, &s.bsdf);
    let replay = Replay::new([xi]).unwrap();
    let set: [(&dyn Technique<Point = Direction>, f64); 2] =
        [(s.light(), prob_smp_light), (&lobe, 1.0 - prob_smp_light)];
    let slides = OneSample::new(&set, 2000).unwrap().weights_without_probabilities();
    let estimate = slides.estimate_from(&f, &replay).unwrap();
    assert_close(estimate.value(), by_hand / 2000.0, 1e-13);
    // Veach's weights, of the same samples, estimate the same.
    let veach = OneSample::new(&set, 2000).unwrap().estimate_from(&f, &replay).unwrap();
    let error = veach.standard_error().unwrap() + estimate.standard_error().unwrap();
    assert!((veach.value() - estimate.value()).abs() < 5.0 * error);
    assert!(error < 0.2 * veach.value(), "{veach} {estimate}");
}

#[test]
fn emitted_radiance_is_that_of_an_unobstructed_light() {
    let s = setting();
    let through_the_ball = direction(0.5, 0.3, 1.0);
    assert_eq!(s.light().emitted(&through_the_ball), 3.0);
    assert_eq!(s.incident.radiance(&through_the_ball), 0.0);
    assert_eq!(s.light().emitted(&direction(-1.0, 0.0, 1.0)), 0.0);
    assert_eq!(horizontal().mirror(), horizontal().normal());
}

#[test]
fn the_power_of_a_light_is_its_radiance_times_its_area() {
    assert_close(sphere_light(DVec3::Z, 0.5, 3.0).power(), 3.0 * std::f64::consts::PI, 1e-15);
    let panel = Rectangle::new(DVec3::Z, 0.5 * DVec3::X, 2.0 * DVec3::Y).unwrap();
    assert_eq!(Light::new(panel, [3.0, 1.0]).unwrap().power(), [24.0, 8.0]);
    let front = Light::one_sided(panel, [3.0, 1.0]).unwrap();
    assert_eq!(front.power(), [12.0, 4.0]);
    // It is seen from the side of the normal only.
    assert!(front.seen_from(DVec3::new(9.0, 0.0, 1.5)).is_ok());
    for behind in [DVec3::ZERO, DVec3::new(9.0, 0.0, 0.5)] {
        let error = front.seen_from(behind).unwrap_err();
        assert_eq!((error.owner(), error.rule()), ("Light", "it must be on the side that emits"));
    }
    assert!(front.seen_from(DVec3::new(9.0, 0.0, 1.0)).is_err());
}
