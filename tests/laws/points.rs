//! Points of several dimensions, and mixtures.

use super::wrappers::{numeric_normal, sine, steps};
use crate::common::laws::{canonical_numbers, chi_squared, kolmogorov};
use crate::common::point_laws::check_points;
use mis::technique::{
    InverseCdf, Mixture, PowerLaw, Product, ProductVec, Technique, Uniform, UniformBox, canonical,
};

/// The laws of points, on the smallest example.
#[test]
fn points() {
    struct Square(PowerLaw);

    impl Technique for Square {
        type Point = [f64; 2];

        fn dimension(&self) -> usize {
            2
        }

        fn sample(&self, xi: &[f64]) -> [f64; 2] {
            [0, 1].map(|d| self.0.inverse_cdf(canonical(xi, d)))
        }

        fn pdf(&self, x: &[f64; 2]) -> f64 {
            self.0.pdf(&x[0]) * self.0.pdf(&x[1])
        }
    }

    let p = PowerLaw::new(1.0, 0.5, 2.0).unwrap();
    check_points(&Square(p), &[&p, &p], &|x| [x[0], x[1]], 100_000, 1e-6);
}

#[test]
fn product_of_two_and_three() {
    let p = Product::new([numeric_normal().unwrap(), numeric_normal().unwrap()]).unwrap();
    let normal = numeric_normal().unwrap();
    check_points(&p, &[&normal, &normal], &|x| [x[0], x[1]], 100_000, 1e-12);

    let (steps, sine) = (steps().unwrap(), sine().unwrap());
    let unit = Uniform::unit();
    let coordinates: [&dyn InverseCdf; 3] = [&steps, &sine, &unit];
    let p = Product::new(coordinates).unwrap();
    check_points(&p, &coordinates, &|x| [x[0], x[1], x[2]], 100_000, 1e-12);
}

#[test]
fn product_of_run_time_length() {
    let coordinates: Vec<Box<dyn InverseCdf>> =
        vec![Box::new(Uniform::unit()), Box::new(sine().unwrap()), Box::new(steps().unwrap())];
    let p = ProductVec::new(coordinates).unwrap();
    let marginals: [&dyn InverseCdf; 3] = [&Uniform::unit(), &sine().unwrap(), &steps().unwrap()];
    check_points(&p, &marginals, &|x| x.to_vec(), 100_000, 1e-12);
}

#[test]
fn product_in_a_thousand_dimensions() {
    let side = Uniform::new(0.0, 10.0).unwrap();
    let p = ProductVec::new(vec![side; 1000]).unwrap();
    let marginals = vec![&side as &dyn InverseCdf; 1000];
    check_points(&p, &marginals, &|x| x.to_vec(), 1000, 0.0);
}

#[test]
fn uniform_box() {
    let p = UniformBox::uniform([0.0, -1e9, 1e-9], [1e-300, 1e9, 2e-9]).unwrap();
    let [a, b, c] = *p.coordinates();
    check_points(&p, &[&a, &b, &c], &|x| [x[0], x[1], x[2]], 100_000, 1e-12);
    let p = ProductVec::uniform(&[0.0, -1.0], &[1.0, 3.0]).unwrap();
    let (a, b) = (p.coordinates()[0], p.coordinates()[1]);
    check_points(&p, &[&a, &b], &|x| x.to_vec(), 100_000, 1e-12);
}

/// A mixture on the line: its CDF is the mixture of the CDFs.
#[test]
fn mixture_on_the_line() {
    let parts = [
        (Uniform::new(0.0, 4.0).unwrap(), 0.5),
        (Uniform::new(1.0, 2.0).unwrap(), 0.0),
        (Uniform::new(3.0, 3.5).unwrap(), 0.3),
        (Uniform::new(-7.0, -6.0).unwrap(), 0.2),
    ];
    let p = Mixture::new(parts.to_vec()).unwrap();
    let xis = canonical_numbers(4, 2 * 100_000);
    let mut xs = Vec::new();
    p.sample_batch(&xis, &mut xs);
    let mut pdfs = vec![0.0; xs.len()];
    p.pdf_batch(&xs, &mut pdfs);
    for (x, pdf) in xs.iter().zip(&pdfs) {
        assert!(*pdf > 0.0 && pdf.to_bits() == p.pdf(x).to_bits());
        assert!((p.ln_pdf(x) - pdf.ln()).abs() <= 8.0 * f64::EPSILON * pdf.ln().abs().max(1.0));
    }
    let cdf = |x: f64| parts.iter().map(|(part, p)| p * part.cdf(x)).sum::<f64>();
    let edges: Vec<f64> = (0..=44).map(|k| -7.0 + 0.25 * f64::from(k)).collect();
    let masses: Vec<f64> = edges.windows(2).map(|e| cdf(e[1]) - cdf(e[0])).collect();
    let densities = edges.windows(2).map(|e| (e[1] - e[0]) * p.pdf(&(0.5 * (e[0] + e[1]))));
    assert!(masses.iter().zip(densities).all(|(m, d)| (m - d).abs() <= 4.0 * f64::EPSILON));
    chi_squared(&masses, xs.iter().map(|x| edges.partition_point(|e| e <= x) - 1));
    kolmogorov(&mut xs.iter().map(|&x| cdf(x)).collect::<Vec<f64>>());
}
