//! Points of several dimensions, and mixtures.

use super::wrappers::{numeric_normal, sine, steps};
use mis::check::Options;
use mis::technique::{
    InverseCdf, Mixture, PiecewiseConstant, PowerLaw, Product, ProductVec, Technique, Uniform,
    UniformBox, canonical,
};
use std::fmt::Debug;

/// Every law, by a reference that is the product of the marginals: its canonical numbers are the
/// marginals' CDFs. The integral to `integral`, each statistical law at 1e-5.
fn check_points<P: AsRef<[f64]> + Debug>(
    p: &dyn Technique<Point = P>,
    reference: &dyn Technique<Point = P>,
    marginals: &[&dyn InverseCdf],
    make: &dyn Fn(&[f64]) -> P,
    n: usize,
    integral: f64,
) {
    let ranks =
        |x: &P| -> Vec<f64> { marginals.iter().zip(x.as_ref()).map(|(m, x)| m.cdf(*x)).collect() };
    let len = marginals.len();
    let laws = 1 + 2 * len + if len <= 6 { len * (len - 1) / 2 } else { (len - 1).min(100) };
    let options = Options::strict().samples(n).integral(integral);
    let options = options.false_alarms(1e-5 * laws as f64);
    let report = mis::check::technique(p, reference, ranks, &options);
    assert!(report.passed(), "{report}");
    // Quadrature, not sampling, has told the integral.
    let bound = report.get(mis::check::Law::Integral).unwrap().allowed();
    assert!(len > 3 || bound <= integral, "{report}");
    assert!(p.point_len().is_none_or(|own| own == len));
    outside(p, marginals, make);
}

/// One coordinate outside its support, or NaN, is no density.
fn outside<P>(
    p: &dyn Technique<Point = P>,
    marginals: &[&dyn InverseCdf],
    make: &dyn Fn(&[f64]) -> P,
) {
    let centre: Vec<f64> = marginals.iter().map(|m| m.inverse_cdf(0.5)).collect();
    for (d, marginal) in marginals.iter().enumerate() {
        let (a, b) = marginal.support();
        for edge in [a.next_down(), b.next_up()] {
            let mut x = centre.clone();
            x[d] = edge;
            assert_eq!(p.pdf(&make(&x)), 0.0, "pdf({x:?})");
            assert_eq!(p.ln_pdf(&make(&x)), f64::NEG_INFINITY, "ln_pdf({x:?})");
        }
        let mut x = centre.clone();
        x[d] = f64::NAN;
        let pdf = p.pdf(&make(&x));
        assert!(pdf.is_nan() || pdf == 0.0, "pdf({x:?}) = {pdf}");
    }
}

/// The product of these marginals, with points of an array.
fn array<const D: usize>(marginals: [&dyn InverseCdf; D]) -> Product<&dyn InverseCdf, D> {
    Product::new(marginals).unwrap()
}

/// The same with points of run-time length.
fn vector<'a>(marginals: &[&'a dyn InverseCdf]) -> ProductVec<&'a dyn InverseCdf> {
    ProductVec::new(marginals.to_vec()).unwrap()
}

const FEW: usize = 20_000;
const MANY: usize = 1_000_000;

/// Tests of points by few samples, and by many.
macro_rules! laws_of_points {
    ($($name:ident $many:ident: $laws:ident;)*) => {$(
        #[test]
        fn $name() {
            $laws(FEW);
        }

        #[test]
        #[ignore = "1e6 samples: run in release"]
        fn $many() {
            $laws(MANY);
        }
    )*};
}

laws_of_points! {
    points points_battery: of_the_smallest_example;
    product_of_two_and_three product_of_two_and_three_battery: of_two_and_three;
    product_of_run_time_length product_of_run_time_length_battery: of_run_time_length;
    uniform_box uniform_box_battery: of_boxes;
}

/// The laws of points, on the smallest example.
fn of_the_smallest_example(n: usize) {
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
    check_points(&Square(p), &array([&p, &p]), &[&p, &p], &|x| [x[0], x[1]], n, 1e-6);
}

fn of_two_and_three(n: usize) {
    let p = Product::new([numeric_normal().unwrap(), numeric_normal().unwrap()]).unwrap();
    let normal = numeric_normal().unwrap();
    check_points(&p, &array([&normal, &normal]), &[&normal, &normal], &|x| [x[0], x[1]], n, 1e-12);

    let (steps, sine) = (steps().unwrap(), sine().unwrap());
    let unit = Uniform::unit();
    let coordinates: [&dyn InverseCdf; 3] = [&steps, &sine, &unit];
    let p = Product::new(coordinates).unwrap();
    check_points(&p, &array(coordinates), &coordinates, &|x| [x[0], x[1], x[2]], n, 1e-12);
}

fn of_run_time_length(n: usize) {
    let coordinates: Vec<Box<dyn InverseCdf>> =
        vec![Box::new(Uniform::unit()), Box::new(sine().unwrap()), Box::new(steps().unwrap())];
    let p = ProductVec::new(coordinates).unwrap();
    let marginals: [&dyn InverseCdf; 3] = [&Uniform::unit(), &sine().unwrap(), &steps().unwrap()];
    check_points(&p, &vector(&marginals), &marginals, &|x| x.to_vec(), n, 1e-12);
}

#[test]
fn product_in_a_thousand_dimensions() {
    let side = Uniform::new(0.0, 10.0).unwrap();
    let p = ProductVec::new(vec![side; 1000]).unwrap();
    let marginals = vec![&side as &dyn InverseCdf; 1000];
    check_points(&p, &vector(&marginals), &marginals, &|x| x.to_vec(), 400, 0.0);
}

fn of_boxes(n: usize) {
    let p = UniformBox::uniform([0.0, -1e9, 1e-9], [1e-300, 1e9, 2e-9]).unwrap();
    let [a, b, c] = *p.coordinates();
    check_points(&p, &array([&a, &b, &c]), &[&a, &b, &c], &|x| [x[0], x[1], x[2]], n, 1e-12);
    let p = ProductVec::uniform(&[0.0, -1.0], &[1.0, 3.0]).unwrap();
    let (a, b) = (p.coordinates()[0], p.coordinates()[1]);
    check_points(&p, &vector(&[&a, &b]), &[&a, &b], &|x| x.to_vec(), n, 1e-12);
}

/// A mixture on the line: its steps are those of a table.
#[test]
fn mixture_on_the_line() {
    let parts = vec![
        (Uniform::new(0.0, 4.0).unwrap(), 0.5),
        (Uniform::new(1.0, 2.0).unwrap(), 0.0),
        (Uniform::new(3.0, 3.5).unwrap(), 0.3),
        (Uniform::new(-7.0, -6.0).unwrap(), 0.2),
    ];
    let p = Mixture::new(parts).unwrap();
    let edges = [-7.0, -6.0, 0.0, 3.0, 3.5, 4.0];
    let table = PiecewiseConstant::new(&edges, &[0.2, 0.0, 0.375, 0.3625, 0.0625]).unwrap();
    let options = Options::strict().integral(1e-12).false_alarms(3e-5);
    let report = mis::check::technique(&p, &table, |x| [table.cdf(*x)], &options);
    assert!(report.passed(), "{report}");
    assert!(report.get(mis::check::Law::Integral).unwrap().allowed() <= 1e-12, "{report}");
    for x in [-7.1, -3.0, 4.1, f64::NAN] {
        assert_eq!(p.pdf(&x), 0.0);
    }
}
