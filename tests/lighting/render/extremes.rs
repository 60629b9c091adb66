//! Cameras, lights and lobes at the ends of their ranges.

use super::{Strategy, error_of, only, spot, strategies};
use crate::support::{sphere_light, white};
use mis::lighting::{
    Camera, Combination, DVec3, GgxConductor, Lambert, Light, LightChoice, ModifiedPhong,
    Rectangle, Scene, Sphere,
};

fn floor() -> Rectangle {
    Rectangle::new(DVec3::ZERO, 3.0 * DVec3::X, 3.0 * DVec3::Y).unwrap()
}

/// Each strategy's value of the point at the origin as seen from `eye`: within 5 standard errors, and
/// these within `relative` of the value.
fn assert_all(scene: &Scene<f64>, eye: DVec3, exact: f64, relative: impl Fn(&Strategy) -> f64) {
    for strategy in strategies() {
        let picture = strategy.renderer(scene, &spot(eye, DVec3::ZERO), 512).render(7).unwrap();
        let ((value, error), relative) = (only(&picture), relative(&strategy));
        // What is left of a spot 1e-9 wide, and of the digits of a direction beside a lobe.
        let difference = (value - exact).abs() - 2e-8 * exact;
        let what = format!("{strategy:?}: {value} ± {error} for {exact}");
        assert!(difference < 5.0 * error && error <= relative * exact, "{what}");
    }
}

#[test]
fn a_grazing_camera_sees_the_albedo_in_a_furnace() {
    let scene = Scene::new()
        .light(sphere_light(DVec3::ZERO, 50.0, 1.0))
        .surface(floor(), Lambert::new(0.6).unwrap());
    for height in [1e-3, 1e-6, 1e-9, 1e-12, 1e-14] {
        let eye = DVec3::new(0.0, -2.0, height);
        let picture =
            Strategy::BSDF.renderer(&scene, &spot(eye, DVec3::ZERO), 64).render(1).unwrap();
        let (value, error) = only(&picture);
        // Rays of the spot that pass above or below the floor would see the light.
        if height > 1e-8 {
            assert!((value - 0.6).abs() < 1e-15 && error < 1e-16, "{height}: {value} ± {error}");
        } else {
            assert!((0.6 - 1e-15..=1.0).contains(&value), "{height}: {value}");
        }
    }
}

#[test]
fn glossy_floors_at_a_grazing_angle_are_finite_and_not_too_bright() {
    let furnace = Scene::new().light(sphere_light(DVec3::ZERO, 50.0, 1.0));
    for height in [1e-3, 1e-6] {
        let eye = DVec3::new(0.0, -2.0, height);
        for alpha in [1e-8, 1e-4, 0.1, 1.0] {
            // A conductor reflects at most all.
            let scene = furnace.clone().surface(floor(), GgxConductor::new(1.0, alpha).unwrap());
            let camera = spot(eye, DVec3::ZERO);
            let picture = Strategy::BSDF.renderer(&scene, &camera, 400).render(1).unwrap();
            let (value, error) = only(&picture);
            assert!(value > 0.0 && value < 1.0 + 5.0 * error, "{height} {alpha}: {value} {error}");
        }
    }
}

#[test]
fn lights_of_equal_power_from_huge_to_tiny() {
    // L = 1 / r²: π L (r / d)² cos θ whatever r, with the whole light above the horizon.
    for r in [1e8, 1.0, 1e-4, 1e-8] {
        let centre = 2.0 * f64::max(r, 1.0) * DVec3::new(0.6, 0.0, 0.8);
        let scene =
            Scene::new().light(sphere_light(centre, r, 1.0 / (r * r))).surface(floor(), white());
        let exact = 0.8 / centre.length_squared();
        let eye = DVec3::new(-0.5, -2.0, 1.0);
        if r >= 1.0 {
            assert_all(&scene, eye, exact, |_| 0.1);
            continue;
        }
        // The BSDF does not find a tiny light: half of a constant sum is missing, and nobody is told.
        for strategy in strategies() {
            let picture =
                strategy.renderer(&scene, &spot(eye, DVec3::ZERO), 512).render(3).unwrap();
            let (value, error) = only(&picture);
            let (expected, relative) = match strategy {
                Strategy { samples: [0, _], .. } => (0.0, 0.0),
                Strategy { combination: Combination::Constant, .. } => (0.5 * exact, 0.1 * r),
                // How many samples are of the light is a matter of chance.
                Strategy { combination: Combination::OneSample, .. } => (exact, 0.04),
                _ => (exact, 0.1 * r),
            };
            let what = format!("{r} {strategy:?}: {value} ± {error} for {expected}");
            assert!((value - expected).abs() <= 5.0 * error + 1e-9 * expected, "{what}");
            assert!(error <= relative * exact, "{what}");
        }
    }
}

#[test]
fn smooth_conductors_mirror_a_light() {
    // Looking down on it, tan²(t/2) / (α² + tan²(t/2)) of the lobe is within t of the mirror direction;
    // shadowing is as good as 1.
    for alpha in [1e-8_f64, 1e-6, 1e-3] {
        let t = 2.0 * alpha;
        let lamp = sphere_light(8.0 * DVec3::Z, 8.0 * t.sin(), 3.0);
        let scene =
            Scene::new().light(lamp).surface(floor(), GgxConductor::new(0.9, alpha).unwrap());
        let tan2 = (0.5 * t).tan().powi(2);
        let exact = 3.0 * 0.9 * tan2 / (alpha * alpha + tan2);
        assert_all(&scene, 5.0 * DVec3::Z, exact, |_| 0.1);
    }
}

#[test]
fn radiances_60_orders_of_magnitude_apart() {
    let lamp = |x: f64, radiance| {
        Light::new(Sphere::new(DVec3::new(x, 0.0, 2.0), 0.5).unwrap(), radiance).unwrap()
    };
    let scene = Scene::new()
        .light(lamp(2.0, [1e30, 0.0]))
        .light(lamp(-2.0, [0.0, 1e-30]))
        .surface(floor(), Lambert::new([1.0; 2]).unwrap());
    let exact = 0.25 / 8.0 * 0.5f64.sqrt();
    for strategy in strategies().into_iter().filter(|s| s.choice != LightChoice::Power) {
        let camera = spot(DVec3::new(0.0, -2.0, 1.0), DVec3::ZERO);
        let picture = strategy.renderer(&scene, &camera, 512).render(3).unwrap();
        let (value, error) = (picture.mean(), picture.standard_error_of_mean().unwrap());
        for (c, scale) in [1e30, 1e-30].into_iter().enumerate() {
            let (value, error) = (value[c] / scale, error[c] / scale);
            let z = (value - exact) / error;
            assert!(z.abs() < 5.0 && error < 0.35 * exact, "{strategy:?}: {value} ± {error}");
        }
    }
}

/// A scene with a floor.
type OnFloor = dyn Fn(Scene<f64>) -> Scene<f64>;

#[test]
fn every_number_is_finite() {
    let lobes: [Box<OnFloor>; 6] = [
        Box::new(|scene| scene.surface(floor(), white())),
        Box::new(|scene| scene.surface(floor(), GgxConductor::new(1.0, 1e-8).unwrap())),
        Box::new(|scene| scene.surface(floor(), GgxConductor::new(1.0, 1.0).unwrap())),
        Box::new(|scene| scene.surface(floor(), ModifiedPhong::new(1.0, 0.0).unwrap())),
        Box::new(|scene| scene.surface(floor(), ModifiedPhong::new(1.0, 30_000.0).unwrap())),
        Box::new(|scene| scene.surface(floor(), ModifiedPhong::new(1.0, 1e12).unwrap())),
    ];
    let rectangle = |centre, x, y| Rectangle::new(centre, x, y).unwrap().into();
    let lights: [mis::lighting::Shape; 8] = [
        Sphere::new(DVec3::Z, 1e-8).unwrap().into(),
        Sphere::new((1e8 + 1.0) * DVec3::Z, 1e8).unwrap().into(),
        // Astride of the horizon, and below it.
        Sphere::new(2.0 * DVec3::X, 0.5).unwrap().into(),
        Sphere::new(-2.0 * DVec3::Z, 0.5).unwrap().into(),
        rectangle(DVec3::Z, 0.5e-8 * DVec3::X, 0.5e-8 * DVec3::Y),
        rectangle(DVec3::Z, 0.5e12 * DVec3::X, 0.5 * DVec3::Y),
        rectangle(DVec3::new(1.0, 0.0, 1e-12), 0.5 * DVec3::X, 0.5 * DVec3::Y),
        // In the plane of the camera's eye, and of the floor.
        rectangle(DVec3::ZERO, 0.5 * DVec3::X, 0.5 * DVec3::Y),
    ];
    for (height, size) in [(1.0, 0.5), (1e-9, 1e-9)] {
        let eye = DVec3::new(0.0, -1.0, height);
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, size, 2, 2).unwrap();
        for (k, light) in lights.iter().enumerate() {
            for (j, with_floor) in lobes.iter().enumerate() {
                let scene = with_floor(Scene::new().light(Light::new(*light, 2.0).unwrap()));
                for strategy in strategies() {
                    let picture = strategy.renderer(&scene, &camera, 8).render(1).unwrap();
                    for pixel in picture.pixels() {
                        let (value, error) = (pixel.value(), error_of(pixel));
                        let finite = value.is_finite() && error.is_finite();
                        assert!(finite, "light {k}, lobe {j}, {strategy:?}: {value} ± {error}");
                    }
                }
            }
        }
    }
}
