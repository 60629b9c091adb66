//! The problems: integrand, techniques, exact value.

use std::error::Error;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Debug;

use mis::lighting::{
    Bsdf, DVec3, Direction, Light, ModifiedPhong, ReflectedRadiance, Scene, Sphere, Surface,
};
use mis::technique::{
    Exponential, FnTechnique, Linear, Normal, NumericInverse, PowerLaw, Product, TruncatedNormal,
    Uniform, UniformBox,
};
use mis::{ArgumentError, Integrand, InverseCdf, Technique};

/// One problem.
pub(crate) struct Case<'a, P, F: ?Sized> {
    pub(crate) name: &'static str,
    /// Integrand, domain and densities, for a reader.
    pub(crate) about: &'static str,
    pub(crate) exact: f64,
    pub(crate) f: &'a F,
    pub(crate) techniques: Vec<Named<'a, P>>,
    /// What a sample, a pdf, the integrand and all else cost on the machine that this was written on,
    /// in nanoseconds.
    pub(crate) costs: Nanoseconds,
}

/// A technique, its name, and whether it is of use alone, in that its variance is finite and can be
/// measured.
pub(crate) struct Named<'a, P> {
    pub(crate) name: &'static str,
    pub(crate) technique: &'a dyn Technique<Point = P>,
    pub(crate) alone: bool,
}

pub(crate) struct Nanoseconds {
    pub(crate) sampling: &'static [f64],
    pub(crate) pdf: &'static [f64],
    pub(crate) integrand: f64,
    pub(crate) combining: f64,
}

/// What is done with each problem.
pub(crate) trait Visit {
    fn visit<P: Debug + Sync, F: Integrand<P, Value = f64> + Sync>(
        &mut self,
        case: &Case<'_, P, F>,
    ) -> Result<(), Box<dyn Error>>;
}

/// How many techniques the problems have.
pub(crate) const TECHNIQUES: [u64; 9] = [2, 3, 2, 3, 3, 2, 4, 2, 2];

/// All problems, one after the other.
pub(crate) fn visit_all(visitor: &mut impl Visit) -> Result<(), Box<dyn Error>> {
    sine_cosine(visitor)?;
    family_a(visitor)?;
    families_d_e(visitor)?;
    product(visitor)?;
    peaks(visitor)?;
    lighting(visitor)
}

fn named<'a, P>(
    name: &'static str,
    technique: &'a dyn Technique<Point = P>,
    alone: bool,
) -> Named<'a, P> {
    Named { name, technique, alone }
}

fn sine_cosine(visitor: &mut impl Visit) -> Result<(), Box<dyn Error>> {
    let quarter = [0.0, FRAC_PI_2];
    let cosine = FnTechnique::new(quarter, f64::cos, f64::sin, f64::asin)?;
    let cdf = |x: f64| 2.0 * (0.5 * x).sin().powi(2);
    let sine = FnTechnique::new(quarter, f64::sin, cdf, |u| 2.0 * (0.5 * u).sqrt().asin())?;
    let uniform = Uniform::new(0.0, FRAC_PI_2)?;
    let f = |x: &f64| x.sin() * x.cos();
    visitor.visit(&Case {
        name: "sin x cos x",
        about: "f = sin x cos x on [0, π/2]; p₁ = cos x, p₂ = sin x",
        exact: 0.5,
        f: &f,
        techniques: vec![named("cos", &cosine, true), named("sin", &sine, true)],
        costs: Nanoseconds {
            sampling: &[12.5, 12.0],
            pdf: &[8.2, 7.9],
            integrand: 10.0,
            combining: 3.5,
        },
    })?;
    visitor.visit(&Case {
        name: "sin x cos x, with uniform",
        about: "f = sin x cos x on [0, π/2]; p₁ = cos x, p₂ = sin x, p₃ = 2/π",
        exact: 0.5,
        f: &f,
        techniques: vec![
            named("cos", &cosine, true),
            named("sin", &sine, true),
            named("uniform", &uniform, true),
        ],
        costs: Nanoseconds {
            sampling: &[12.5, 12.0, 0.5],
            pdf: &[8.2, 7.9, 0.2],
            integrand: 10.0,
            combining: 3.5,
        },
    })
}

fn family_a(visitor: &mut impl Visit) -> Result<(), Box<dyn Error>> {
    let [a, b] = [0.01, FRAC_PI_2];
    let mass = |x: f64| 0.5 * x - 0.25 * (2.0 * x).sin();
    let norm = mass(b) - mass(a);
    let squared = NumericInverse::new(
        [a, b],
        move |x| x.sin().powi(2) / norm,
        move |x| (mass(x) - mass(a)) / norm,
    )?;
    let ramp = Linear::new(a, b, 2.0 - a, 2.0 - b)?;
    visitor.visit(&Case {
        name: "A: √x + sin x",
        about: "f = √x + sin x on [0.01, π/2]; p₁ ∝ 2 − x, p₂ ∝ sin² x",
        exact: 2.0 / 3.0 * (b.powf(1.5) - a.powf(1.5)) + a.cos() - b.cos(),
        f: &|x: &f64| x.sqrt() + x.sin(),
        techniques: vec![named("2 − x", &ramp, true), named("sin²", &squared, true)],
        costs: Nanoseconds {
            sampling: &[6.5, 315.0],
            pdf: &[1.9, 8.1],
            integrand: 7.7,
            combining: 3.6,
        },
    })
}

fn families_d_e(visitor: &mut impl Visit) -> Result<(), Box<dyn Error>> {
    let ends @ [a, b] = [1.5 / PI, PI];
    let parabola = |x: f64| x.powi(3) / 3.0 - x * x / (2.0 * PI);
    let norm = parabola(b) - parabola(a);
    let pdf = move |x: f64| x * (x - 1.0 / PI) / norm;
    let parabolic = NumericInverse::new(ends, pdf, move |x| (parabola(x) - parabola(a)) / norm)?;
    // 1 + cos x = 2 cos²(x/2), without cancellation at π.
    let mass = 2.0 * (0.5 * a).cos().powi(2);
    let sine = FnTechnique::new(
        ends,
        move |x| x.sin() / mass,
        move |x| 1.0 - 2.0 * (0.5 * x).cos().powi(2) / mass,
        move |u| 2.0 * (0.5 * (1.0 - u) * mass).sqrt().acos(),
    )?;
    let ramp = Linear::new(a, b, a, b)?;
    let exact = |slope: f64| 0.5 * slope * (b * b - a * a) + norm + mass;
    let techniques = || {
        // f² / p₃ has a pole at π: its integral diverges like a logarithm.
        vec![
            named("x", &ramp, true),
            named("x² − x/π", &parabolic, true),
            named("sin", &sine, false),
        ]
    };
    let costs = || Nanoseconds {
        sampling: &[6.4, 266.0, 16.0],
        pdf: &[1.9, 0.5, 9.5],
        integrand: 9.5,
        combining: 3.6,
    };
    visitor.visit(&Case {
        name: "D: in the span",
        about: "f = x + (x² − x/π) + sin x on [3/(2π), π]; p₁ ∝ x, p₂ ∝ x² − x/π, p₃ ∝ sin x, of which \
                f is a combination",
        exact: exact(1.0),
        f: &|x: &f64| x + x * (x - 1.0 / PI) + x.sin(),
        techniques: techniques(),
        costs: costs(),
    })?;
    visitor.visit(&Case {
        name: "E: one good density",
        about: "f = 30 x + (x² − x/π) + sin x, domain and densities as in D; p₁ alone is nearly exact",
        exact: exact(30.0),
        f: &|x: &f64| 30.0 * x + x * (x - 1.0 / PI) + x.sin(),
        techniques: techniques(),
        costs: costs(),
    })
}

fn product(visitor: &mut impl Visit) -> Result<(), Box<dyn Error>> {
    const D: usize = 5;
    let parameters: [_; D] = std::array::from_fn(|d| (0.8 / (d + 1) as f64, 5.0 / (d + 1) as f64));
    let pole = |d: usize| PowerLaw::new(-parameters[d].0, 0.0, 1.0);
    let growth = |d: usize| Exponential::new(-parameters[d].1, 0.0, 1.0);
    let pole = Product::new([pole(0)?, pole(1)?, pole(2)?, pole(3)?, pole(4)?])?;
    let growth = Product::new([growth(0)?, growth(1)?, growth(2)?, growth(3)?, growth(4)?])?;
    // ∫ x^-c e^(λ x) = Σ λ^n / (n! (n + 1 - c)).
    let integral = |&(c, lambda): &(f64, f64)| {
        let (mut power, mut sum) = (1.0, 1.0 / (1.0 - c)); // λ^n / n!
        for n in (1..60).map(f64::from) {
            power *= lambda / n;
            sum += power / (n + 1.0 - c);
        }
        sum
    };
    visitor.visit(&Case {
        name: "product in 5-D",
        about: "f = Π x<sub>d</sub><sup>−c</sup> e<sup>λx<sub>d</sub></sup> on [0, 1]⁵ with c = 0.8/d, \
                λ = 5/d; p₁ ∝ the powers, p₂ ∝ the exponentials (infinite variance alone)",
        exact: parameters.iter().map(integral).product(),
        f: &|x: &[f64; D]| {
            let factors = x.iter().zip(&parameters);
            factors.map(|(x, (c, lambda))| x.powf(-c) * (lambda * x).exp()).product::<f64>()
        },
        techniques: vec![named("powers", &pole, true), named("exponentials", &growth, false)],
        costs: Nanoseconds {
            sampling: &[47.0, 23.0],
            pdf: &[54.0, 15.0],
            integrand: 51.0,
            combining: 8.4,
        },
    })
}

/// Mass, centre on the diagonal, standard deviation.
const PEAKS: [[f64; 3]; 3] = [[0.5, 0.3, 0.08], [0.3, 0.5, 0.12], [0.2, 0.75, 0.10]];

fn peaks(visitor: &mut impl Visit) -> Result<(), Box<dyn Error>> {
    const D: usize = 4;
    // A quarter too wide, as a guess would be.
    let guess = |[_, centre, sd]: [f64; 3]| -> Result<_, ArgumentError> {
        Product::new([TruncatedNormal::new(centre, 1.25 * sd, 0.0, 1.0)?; D])
    };
    let [first, second, third] = PEAKS.map(guess);
    let [first, second, third] = [first?, second?, third?];
    let cube = UniformBox::uniform([0.0; D], [1.0; D])?;
    let mut exact = 0.0;
    for [mass, centre, sd] in PEAKS {
        let normal = Normal::new(centre, sd)?;
        exact += mass * (1.0 - normal.cdf(0.0) - normal.survival(1.0)).powi(4);
    }
    visitor.visit(&Case {
        name: "three peaks in 4-D",
        about: "f = three normal peaks on the diagonal of [0, 1]⁴, of masses 0.5, 0.3, 0.2 and standard \
                deviations 0.08, 0.12, 0.10; a density for each peak, 25 % too wide, and a uniform one",
        exact,
        f: &|x: &[f64; D]| {
            let density = |[mass, centre, sd]: [f64; 3]| {
                let squares: f64 = x.iter().map(|x| ((x - centre) / sd).powi(2)).sum();
                mass * (-0.5 * squares).exp() / (2.0 * PI * sd * sd).powi(2)
            };
            PEAKS.map(density).iter().sum::<f64>()
        },
        techniques: vec![
            named("peak 1", &first, false),
            named("peak 2", &second, false),
            named("peak 3", &third, false),
            named("uniform", &cube, true),
        ],
        costs: Nanoseconds {
            sampling: &[41.0, 41.0, 41.0, 3.1],
            pdf: &[17.0, 17.0, 17.0, 2.8],
            integrand: 71.0,
            combining: 7.5,
        },
    })
}

/// Two cells of E. Veach's figure: the roughest plate under its largest light and under a small one.
fn lighting(visitor: &mut impl Visit) -> Result<(), Box<dyn Error>> {
    const EXPONENT: f64 = 100.0;
    const EYE: DVec3 = DVec3::new(0.0, 2.0, 15.0);
    const UPPER: DVec3 = DVec3::new(0.0, -3.99615, 4.0667);
    const LOWER: DVec3 = DVec3::new(0.0, -3.82069, 3.08221);
    // x of the centre, radius, radiance.
    let lights = [
        (
            "light, large",
            "a sphere of angular radius 9.6° on a Phong lobe of exponent 100, at its mirror point; \
             p₁: the light, p₂: the lobe; neither is good alone",
            [3.75, 0.9, 1.23457],
        ),
        (
            "light, small",
            "a sphere of angular radius 1.1° on a Phong lobe of exponent 100, at its mirror point; \
             p₁: the light, which is nearly exact, p₂: the lobe, which mostly misses it",
            [-1.25, 0.1, 100.0],
        ),
    ];
    for (name, about, [x, radius, radiance]) in lights {
        let normal = Direction::new(DVec3::X.cross(LOWER - UPPER))?;
        let centre = DVec3::new(x, 0.0, 0.0);
        let height = |v: DVec3| (v - UPPER).dot(normal.vector());
        let mirrored = centre - 2.0 * height(centre) * normal.vector();
        let position = EYE.lerp(mirrored, height(EYE) / (height(EYE) + height(centre)));
        let surface = Surface::new(position, normal, Direction::new(EYE - position)?)?;
        let bsdf = ModifiedPhong::new(1.0, EXPONENT)?;
        let light = Light::new(Sphere::new(centre, radius)?, radiance)?;
        let incident = Scene::new().light(light).seen_from(position)?;
        let seen = incident.lights().first().ok_or("no light")?;
        let lobe = bsdf.techniques(&surface).into_iter().next().ok_or("no lobe")?;
        // The lobe is centred on the light, so that only its axis counts: L cos Θ (1 - cosⁿ⁺² θ).
        let one_minus_cos = seen.directions().value() / std::f64::consts::TAU;
        let mass = -((EXPONENT + 2.0) * (-one_minus_cos).ln_1p()).exp_m1();
        visitor.visit(&Case {
            name,
            about,
            exact: radiance * surface.mirror().cos(normal) * mass,
            f: &ReflectedRadiance::new(&incident, surface, &bsdf),
            techniques: vec![named("light", seen, true), named("lobe", &lobe, true)],
            costs: Nanoseconds {
                sampling: &[23.5, 35.5],
                pdf: &[4.0, 9.7],
                integrand: 15.4,
                combining: 4.7,
            },
        })?;
    }
    Ok(())
}
