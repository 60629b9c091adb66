//! The table, by quadrature.

use std::f64::consts::TAU;

use super::{Cell, LIGHTS, PLATES, TABLE, WAYS, Way, integral, of_way};
use crate::support::assert_close;

#[test]
fn relative_variances_by_quadrature() {
    for (plate, rows) in TABLE.iter().enumerate() {
        for (light, row) in rows.iter().enumerate() {
            let nodes = Cell::new(plate, light).nodes(PLATES[plate].2);
            let integral = integral(&nodes);
            // The table has five digits.
            assert_close(integral, row[0], 5e-5);
            for (way, expected) in WAYS.into_iter().zip(&row[1..]) {
                let relative = of_way(&nodes, way).variance / (integral * integral);
                let error = (relative / expected - 1.0).abs();
                assert!(error < 5.5e-5, "{plate} {light} {way:?}: {relative} for {expected}");
            }
        }
    }
}

#[test]
fn the_integral_has_a_closed_form() {
    // The lobe is centred on the light, so that only its axis counts: L cos(Θ) (1 - cosⁿ⁺² θ).
    for (plate, (_, _, exponent)) in PLATES.iter().enumerate() {
        for (light, (_, _, radiance)) in LIGHTS.iter().enumerate() {
            let cell = Cell::new(plate, light);
            let width = cell.light().directions().value() / TAU;
            let mass = -((exponent + 2.0) * (-width).ln_1p()).exp_m1();
            let cos = cell.surface.mirror().cos(cell.surface.normal());
            assert_close(integral(&cell.nodes(*exponent)), radiance * cos * mass, 1e-10);
        }
    }
}

#[test]
fn the_worst_cell_of_each_way() {
    let worst = |way| {
        let place = 1 + WAYS.iter().position(|other| *other == way).unwrap();
        TABLE.iter().flatten().map(|row| row[place]).fold(0.0, f64::max)
    };
    let ways = [Way::Light, Way::Bsdf, Way::Constant, Way::Maximum, Way::OneSample];
    assert_eq!(ways.map(worst), [1048.2, 520.87, 262.06, 0.54007, 0.49810]);
    let ways = [Way::InverseVariance, Way::Balance, Way::Power, Way::Optimal];
    assert_eq!(ways.map(worst), [0.11276, 0.13313, 0.10861, 0.077_386]);
}
