//! One point of a surface under two lights: what each way of sampling makes of it.
//!
//! A sphere and a rectangle shine on a point. For a matte, a glossy and a mixed surface, the table
//! shows every strategy with the same number of samples beside the exact radiance: a closed form
//! where the surface is matte, a quadrature where it is glossy. The last column is what counts:
//! how much faster a strategy reaches the same error than sampling the lights alone.

use std::error::Error;
use std::f64::consts::FRAC_1_PI;
use std::time::Instant;

use mis::lighting::{
    Bsdf, DVec3, Direction, Incident, Lambert, Light, ModifiedPhong, Rectangle, ReflectedRadiance,
    Scene, Sphere, Surface,
};
use mis::technique::Mixture;
use mis::weighting::{Constant, Cutoff, Maximum, Power};
use mis::{
    ArgumentError, Estimate, EstimateError, Estimator, Integrand, MultiSample, OneSample, Technique,
};

type Dyn<'a> = &'a dyn Technique<Point = Direction>;

/// Samples of each strategy, however many techniques share them.
const SAMPLES: u64 = 240_000;

const SPHERE: (DVec3, f64, f64) = (DVec3::new(1.5, -0.2, 2.0), 0.5, 4.0);
const CORNERS: [DVec3; 4] = [
    DVec3::new(-2.0, 0.3, 1.5),
    DVec3::new(-0.5, 0.3, 1.5),
    DVec3::new(-0.5, 1.5, 1.5),
    DVec3::new(-2.0, 1.5, 1.5),
];

fn main() -> Result<(), Box<dyn Error>> {
    let (centre, radius, radiance) = SPHERE;
    let [a, b, _, d] = CORNERS;
    let scene = Scene::new()
        .light(Light::new(Sphere::new(centre, radius)?, radiance)?)
        .light(Light::new(Rectangle::from_corner(a, b - a, d - a)?, 1.0)?);
    let normal = Direction::new(DVec3::Z)?;
    // The eye is where a mirror would show it the edge of the sphere.
    let eye = Direction::new(DVec3::new(-1.3, -0.1, 2.0))?;
    let surface = Surface::new(DVec3::ZERO, normal, eye)?;
    let incident = scene.seen_from(surface.position())?;

    let matte = Lambert::new(0.5)?;
    let glossy = ModifiedPhong::new(0.5, 300.0)?;
    let closed_form = 0.5 * FRAC_1_PI * irradiance(normal);
    let by_quadrature = quadrature(&ReflectedRadiance::new(&incident, surface, &matte), &incident);
    assert!((by_quadrature / closed_form - 1.0).abs() < 1e-9, "{by_quadrature} {closed_form}");
    let glossy_part = quadrature(&ReflectedRadiance::new(&incident, surface, &glossy), &incident);

    println!("{SAMPLES} samples a row; z is the error in standard errors; variance is that of a");
    println!("single sample; gain is the efficiency, 1 / (variance x time), over the first row's.");
    table("Matte: Lambert, albedo 0.5", &incident, surface, &matte, closed_form)?;
    table("Glossy: Phong, exponent 300, albedo 0.5", &incident, surface, &glossy, glossy_part)?;
    let both = (matte, glossy);
    table("Both together", &incident, surface, &both, closed_form + glossy_part)?;
    println!("\nAll estimates agree with the exact radiance within 5 standard errors.");
    Ok(())
}

/// E = π L (r/d)² cos θ of the sphere, and Lambert's formula for the rectangle.
fn irradiance(normal: Direction) -> f64 {
    let (centre, radius, radiance) = SPHERE;
    let d = centre.length();
    let sphere =
        std::f64::consts::PI * radiance * (radius / d).powi(2) * normal.vector().dot(centre) / d;
    let edges = CORNERS.iter().zip(CORNERS.iter().cycle().skip(1)).map(|(v, w)| {
        let cross = v.cross(*w);
        cross.length().atan2(v.dot(*w)) * normal.vector().dot(cross) / cross.length()
    });
    sphere + 0.5 * edges.sum::<f64>().abs()
}

/// ∫ f over each light's solid angle, by Gauss's two-point rule on 300 × 300 cells of ξ. The lights
/// do not overlap.
fn quadrature(f: &impl Integrand<Direction, Value = f64>, incident: &Incident<f64>) -> f64 {
    let cells = 300;
    let offset = 0.5 / 3.0_f64.sqrt();
    let nodes: Vec<f64> = (0..cells)
        .flat_map(|k| [0.5 - offset, 0.5 + offset].map(|t| (f64::from(k) + t) / f64::from(cells)))
        .collect();
    let mut sum = 0.0;
    for light in incident.lights() {
        for u in &nodes {
            for v in &nodes {
                let w = light.sample(&[*u, *v]);
                sum += f.eval(&w) / light.pdf(&w);
            }
        }
    }
    sum / (nodes.len() as f64).powi(2)
}

/// What a row of the table needs of an estimator.
type Run<'a> = Box<dyn Fn(u64) -> Result<Estimate, EstimateError> + 'a>;

fn table<B: Bsdf<Value = f64>>(
    title: &str,
    incident: &Incident<f64>,
    surface: Surface,
    bsdf: &B,
    exact: f64,
) -> Result<(), Box<dyn Error>> {
    let f = ReflectedRadiance::new(incident, surface, bsdf);
    let lobes = bsdf.techniques(&surface);
    let lights: Vec<Dyn<'_>> = incident.lights().iter().map(|light| light as Dyn<'_>).collect();
    let lobes: Vec<Dyn<'_>> = lobes.iter().map(|lobe| lobe as Dyn<'_>).collect();
    let all: Vec<Dyn<'_>> = lights.iter().chain(&lobes).copied().collect();
    let multi = |set: &[_]| MultiSample::new(&share(set));
    // Half of the one-sample selections go to the first light, the others share the rest.
    let rest = 0.5 / (all.len() - 1) as f64;
    let mut selection: Vec<_> = all.iter().map(|technique| (*technique, rest)).collect();
    selection[0].1 = 0.5;
    let one = || OneSample::new(&selection, SAMPLES);

    let (only_lights, only_bsdf, balance) = (multi(&lights)?, multi(&lobes)?, multi(&all)?);
    // Weights that do not depend on the direction need techniques that cover all the light.
    let (any_light, any_lobe) = (mixture(&lights)?, mixture(&lobes)?);
    let constant = multi(&[&any_light, &any_lobe])?.weighting(Constant::equal())?;
    let power = multi(&all)?.weighting(Power::squared())?;
    let cutoff = multi(&all)?.weighting(Cutoff::new(0.1)?)?;
    let maximum = multi(&all)?.weighting(Maximum)?;
    let (veach, slides) = (one()?, one()?.weights_without_probabilities());
    let f = &f;
    let rows: [(&str, Run<'_>); 9] = [
        ("lights only", Box::new(move |seed| only_lights.estimate(f, seed))),
        ("BSDF only", Box::new(move |seed| only_bsdf.estimate(f, seed))),
        ("a light + a lobe, constant 1/2", Box::new(move |seed| constant.estimate(f, seed))),
        ("lights + BSDF, balance", Box::new(move |seed| balance.estimate(f, seed))),
        ("lights + BSDF, power 2", Box::new(move |seed| power.estimate(f, seed))),
        ("lights + BSDF, cutoff 0.1", Box::new(move |seed| cutoff.estimate(f, seed))),
        ("lights + BSDF, maximum", Box::new(move |seed| maximum.estimate(f, seed))),
        ("one-sample, P_i p_i / Σ P_k p_k", Box::new(move |seed| veach.estimate(f, seed))),
        ("one-sample, p_i / Σ p_k", Box::new(move |seed| slides.estimate(f, seed))),
    ];

    println!("\n{title}: exact radiance {exact:.8}\n");
    println!(
        "{:<32} {:>16} {:>6} {:>11} {:>10} {:>8}",
        "strategy", "estimate", "z", "variance", "ns/sample", "gain"
    );
    let mut first = None;
    for (seed, (name, run)) in (1..).zip(&rows) {
        run(seed)?; // warms up caches and branch prediction
        let start = Instant::now();
        let estimate = run(seed)?;
        let seconds = start.elapsed().as_secs_f64();
        let error = estimate.standard_error().ok_or("every contribution is 0")?;
        let z = (estimate.value() - exact) / error;
        assert!(z.abs() < 5.0 && error < 0.05 * exact, "{name}: {estimate} for {exact}, z = {z}");
        let variance = error * error * estimate.samples() as f64;
        let efficiency = 1.0 / (variance * seconds);
        let gain = efficiency / *first.get_or_insert(efficiency);
        let ns = 1e9 * seconds / estimate.samples() as f64;
        println!(
            "{name:<32} {:>16} {z:>6.2} {variance:>11.4e} {ns:>10.1} {gain:>8.3}",
            estimate.to_string()
        );
    }
    Ok(())
}

/// Every technique with the same number of samples.
fn share<'a>(techniques: &[Dyn<'a>]) -> Vec<(Dyn<'a>, u64)> {
    let n = SAMPLES / techniques.len() as u64;
    techniques.iter().map(|technique| (*technique, n)).collect()
}

/// One of the techniques, all with the same probability.
fn mixture<'a>(techniques: &[Dyn<'a>]) -> Result<Mixture<Dyn<'a>>, ArgumentError> {
    let probability = 1.0 / techniques.len() as f64;
    Mixture::new(techniques.iter().map(|technique| (*technique, probability)).collect())
}
