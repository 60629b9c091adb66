//! Radiances that are known: what is seen directly, the white furnace, point lights, small lights.

use std::f64::consts::FRAC_1_PI;

use super::{CHOICES, COMBINATIONS, Strategy, from_above, only, spot, strategies};
use crate::support::{assert_close, sphere_light, white};
use mis::lighting::{
    Camera, Combination, DVec3, Lambert, Light, LightChoice, ModifiedPhong, Pixel, PointLight,
    Rectangle, Scene, Sphere,
};

fn floor() -> Rectangle {
    Rectangle::new(DVec3::ZERO, 3.0 * DVec3::X, 3.0 * DVec3::Y).unwrap()
}

#[test]
fn a_white_furnace_reflects_the_albedo() {
    let scene = Scene::new()
        .light(sphere_light(DVec3::new(1.0, 2.0, -3.0), 20.0, 1.0))
        .surface(floor(), Lambert::new(0.3).unwrap());
    // From above, and the other side of the surface from below.
    for height in [5.0, -5.0] {
        let eye = DVec3::new(0.3, -0.2, height);
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Y, 0.2, 3, 2).unwrap();
        let picture = Strategy::BSDF.renderer(&scene, &camera, 50).render(1).unwrap();
        for pixel in picture.pixels() {
            assert_close(pixel.value(), 0.3, 4.0 * f64::EPSILON);
            assert!(pixel.standard_error().unwrap() < 1e-16);
        }
        for strategy in strategies() {
            let picture = strategy.renderer(&scene, &camera, 200).render(2).unwrap();
            let (value, error) = (picture.mean(), picture.standard_error_of_mean().unwrap());
            let z = (value - 0.3) / error.max(1e-16);
            assert!(z.abs() < 5.0 && error < 0.02, "{strategy:?}: {value} ± {error}");
        }
    }
}

#[test]
fn what_is_seen_directly_is_exact() {
    let eye = DVec3::new(0.0, 0.0, 5.0);
    let lamp = sphere_light(DVec3::new(0.0, 1.0, 2.0), 0.2, 7.0);
    let panel = Rectangle::new(DVec3::new(1.0, 0.0, 1.0), 0.1 * DVec3::X, 0.1 * DVec3::Y).unwrap();
    let down = Rectangle::new(panel.centre(), 0.1 * DVec3::Y, 0.1 * DVec3::X).unwrap();
    let ball = Sphere::new(DVec3::new(-1.0, 0.0, 1.0), 0.1).unwrap();
    let scene = Scene::new().light(lamp).occluder(ball).surface(floor(), white());
    let up = scene.clone().light(Light::one_sided(panel, 3.0).unwrap());
    let from_behind = scene.clone().light(Light::one_sided(down, 3.0).unwrap());
    let (of_panel, beside) = (panel.centre(), DVec3::new(9.0, 9.0, 0.0));
    for (scene, target, exact) in [
        (&up, lamp.shape().centre(), 7.0),
        (&up, of_panel, 3.0),
        // It hides the floor, and is black.
        (&from_behind, of_panel, 0.0),
        (&up, ball.centre(), 0.0),
        (&up, beside, 0.0),
        (&up, 2.0 * eye, 0.0),
    ] {
        for strategy in strategies() {
            let picture = strategy.renderer(scene, &spot(eye, target), 10).render(1).unwrap();
            let (value, error) = only(&picture);
            assert!((value - exact).abs() <= 1e-15 * exact, "{strategy:?}, {target}: {value}");
            assert!(error <= 1e-15 * exact, "{strategy:?}, {target}: {error}");
        }
    }
}

#[test]
fn a_one_sided_light_lights_one_side_and_shadows_the_other() {
    // Between the floor and a lamp, a panel that emits upwards, then one that emits downwards.
    let lamp = sphere_light(DVec3::new(0.0, 0.0, 3.0), 0.5, 2.0);
    let centre = DVec3::new(0.0, 0.0, 1.0);
    let (x, y) = (2.0 * DVec3::X, 2.0 * DVec3::Y);
    let upwards = Light::one_sided(Rectangle::new(centre, x, y).unwrap(), 5.0).unwrap();
    let downwards = Light::one_sided(Rectangle::new(centre, y, x).unwrap(), 5.0).unwrap();
    let camera = spot(DVec3::new(0.0, -4.0, 0.9), DVec3::ZERO);
    for strategy in strategies() {
        let of = |panel| {
            let scene = Scene::new().light(lamp).light(panel).surface(floor(), white());
            only(&strategy.renderer(&scene, &camera, 500).render(1).unwrap())
        };
        assert_eq!(of(upwards), (0.0, 0.0), "{strategy:?}");
        let (value, error) = of(downwards);
        // A square of half a side a above the point: E = 4 L c atan(c), c = a / √(a² + h²).
        let c = 2.0 / 5f64.sqrt();
        let exact = FRAC_1_PI * 5.0 * 4.0 * c * c.atan();
        assert!((value - exact).abs() < 5.0 * error && error < 0.1 * exact, "{value} ± {error}");
    }
}

#[test]
fn a_point_light_is_exact_and_casts_shadows() {
    let at = DVec3::new(1.0, 0.5, 2.0);
    let lit = Scene::new()
        .point_light(PointLight::new(at, 6.0).unwrap())
        .surface(floor(), Lambert::new(0.4).unwrap());
    let ball = Sphere::new(0.5 * at, 0.1).unwrap();
    let shadowed = lit.clone().occluder(ball);
    // A dark light hides, too; beyond the point light it does not.
    let behind_a_light = lit.clone().light(sphere_light(0.5 * at, 0.1, 0.0));
    let before_a_light = lit.clone().light(sphere_light(1.5 * at, 0.1, 0.0));
    let camera = spot(DVec3::new(0.5, -4.0, 3.0), DVec3::ZERO);
    let exact = 6.0 * (2.0 / at.length()) / at.length_squared() * 0.4 * FRAC_1_PI;
    for strategy in strategies() {
        for (scene, exact) in
            [(&lit, exact), (&shadowed, 0.0), (&behind_a_light, 0.0), (&before_a_light, exact)]
        {
            let picture = strategy.renderer(scene, &camera, 4).render(1).unwrap();
            let (value, error) = only(&picture);
            assert!((value - exact).abs() <= 1e-8 * exact, "{strategy:?}: {value} for {exact}");
            assert!(error <= 1e-8 * exact, "{strategy:?}: {error}");
        }
    }
    // On the other side of the floor, it is dark.
    let below = spot(DVec3::new(0.5, -4.0, -3.0), DVec3::ZERO);
    let picture = Strategy::BSDF.renderer(&lit, &below, 4).render(1).unwrap();
    assert_eq!(only(&picture), (0.0, 0.0));
}

#[test]
fn a_sphere_over_a_diffuse_floor() {
    // L (r / d)² cos θ ρ.
    let centre = DVec3::new(1.0, 0.5, 2.0);
    let scene = Scene::new()
        .light(sphere_light(centre, 0.8, 3.0))
        .surface(floor(), Lambert::new(0.4).unwrap());
    let camera = spot(DVec3::new(0.5, -4.0, 3.0), DVec3::ZERO);
    let exact = 0.4 * 3.0 * 0.64 / centre.length_squared() * 2.0 / centre.length();
    for strategy in strategies() {
        let (value, error) = only(&strategy.renderer(&scene, &camera, 500).render(3).unwrap());
        let z = (value - exact) / error;
        let allowed = if strategy == Strategy::BSDF { 0.2 } else { 0.12 };
        let what = format!("{strategy:?}: {value} ± {error} for {exact}");
        assert!(z.abs() < 5.0 && error < allowed * exact, "{what}");
    }
}

#[test]
fn optimal_weights_of_several_lobes_with_a_shadow() {
    // Of two like lobes as of one. A ball hides the middle of the light: the controls need the densities
    // where no light comes from, too.
    let centre = DVec3::new(1.0, 0.5, 2.0);
    let half = |albedo| Lambert::new(albedo).unwrap();
    let scene = Scene::new()
        .light(sphere_light(centre, 1.8, 3.0))
        .surface(floor(), (half(0.1), half(0.3)))
        .occluder(Sphere::new(0.15 * centre, 0.18).unwrap());
    let camera = spot(DVec3::new(0.5, -4.0, 3.0), DVec3::ZERO);
    let squares = 1.8 * 1.8 - 1.2 * 1.2;
    let exact = 0.4 * 3.0 * squares / centre.length_squared() * 2.0 / centre.length();
    for choice in CHOICES {
        let strategy = Strategy { combination: Combination::Optimal, choice, samples: [1, 1] };
        let (value, error) = only(&strategy.renderer(&scene, &camera, 8192).render(3).unwrap());
        let z = (value - exact) / error;
        assert!(z.abs() < 5.0 && error < 0.02 * exact, "{choice:?}: {value} ± {error}, {exact}");
    }
}

#[test]
fn a_highlight_of_the_lobe_about_the_mirror_direction() {
    // The light is centred on the mirror direction: L cos Θ ρ (1 - cosⁿ⁺² θ).
    let mirror = DVec3::new(0.0, 0.6, 0.8);
    for (exponent, r) in [(0.0, 0.3), (100.0, 0.1), (1e6, 1e-3), (1e12, 1e-6)] {
        let scene = Scene::new()
            .light(sphere_light(2.0 * mirror, 2.0 * r, 5.0))
            .surface(floor(), ModifiedPhong::new(0.7, exponent).unwrap());
        let camera = spot(4.0 * DVec3::new(0.0, -0.6, 0.8), DVec3::ZERO);
        let width = r * r / (1.0 + (1.0 - r * r).sqrt());
        let exact = -5.0 * 0.8 * 0.7 * ((exponent + 2.0) * (-width).ln_1p()).exp_m1();
        for strategy in strategies() {
            let (value, error) = only(&strategy.renderer(&scene, &camera, 500).render(4).unwrap());
            let what = format!("{exponent} {strategy:?}: {value} ± {error} for {exact}");
            assert!((value - exact).abs() < 5.0 * error && error < 0.2 * exact, "{what}");
        }
    }
}

#[test]
fn the_share_of_the_lights() {
    let scene = Scene::new()
        .light(sphere_light(DVec3::new(1.0, 0.0, 2.0), 0.8, 3.0))
        .light(sphere_light(DVec3::new(-1.0, 0.0, 2.0), 0.5, 3.0))
        .surface(floor(), white());
    let camera = from_above(2);
    let shares = |combination, choice, samples| {
        let strategy = Strategy { combination, choice, samples };
        let picture = strategy.renderer(&scene, &camera, 64).render(1).unwrap();
        picture.pixels().iter().map(Pixel::light_share).collect::<Vec<_>>()
    };
    for combination in COMBINATIONS {
        for choice in CHOICES {
            if (combination, choice) == (Combination::Constant, LightChoice::Each) {
                continue;
            }
            let of = |samples| shares(combination, choice, samples);
            if combination == Combination::Optimal {
                assert_eq!(of([1, 1]), [None; 4]);
                continue;
            }
            assert_eq!(of([1, 0]), [Some(1.0); 4], "{combination:?} {choice:?}");
            assert_eq!(of([0, 1]), [Some(0.0); 4], "{combination:?} {choice:?}");
            for share in of([1, 1]) {
                let share = share.unwrap();
                let all = share == 0.0 || share == 1.0;
                assert!((0.0..=1.0).contains(&share), "{combination:?} {choice:?}: {share}");
                assert!(!all || combination == Combination::Maximum, "{combination:?} {choice:?}");
            }
        }
    }
    // Equal weights, equal shares, up to their errors.
    for share in shares(Combination::Constant, LightChoice::Uniform, [8, 8]) {
        assert!((share.unwrap() - 0.5).abs() < 0.1, "{share:?}");
    }
}

#[test]
fn a_light_that_is_not_seen_adds_nothing() {
    // In the plane of the floor, and one that faces away: they take samples of the lights all the same.
    let centre = DVec3::new(1.0, 0.5, 2.0);
    let beside = DVec3::new(7.0, 0.0, 0.0);
    let level = Rectangle::new(beside, 2.0 * DVec3::X, 2.0 * DVec3::Y).unwrap();
    let away = Rectangle::new(beside + 3.0 * DVec3::Z, 2.0 * DVec3::X, 2.0 * DVec3::Y).unwrap();
    let scene = Scene::new()
        .light(Light::new(level, 1.0).unwrap())
        .light(sphere_light(centre, 1.5, 3.0))
        .light(Light::one_sided(away, 1.0).unwrap())
        .surface(floor(), Lambert::new(0.4).unwrap());
    let camera = spot(DVec3::new(0.5, -4.0, 3.0), DVec3::ZERO);
    let exact = 0.4 * 3.0 * 2.25 / centre.length_squared() * 2.0 / centre.length();
    for strategy in strategies() {
        let (value, error) = only(&strategy.renderer(&scene, &camera, 1000).render(3).unwrap());
        let what = format!("{strategy:?}: {value} ± {error} for {exact}");
        assert!((value - exact).abs() < 5.0 * error && error < 0.06 * exact, "{what}");
    }
}

#[test]
fn as_many_samples_as_lights_take_each_once() {
    // Of specks, every sample is worth the same; which of them it is of makes all the difference.
    let r = 1e-6;
    let speck = |x: f64, radiance| sphere_light(DVec3::new(x, 0.0, 2.0), r, radiance / (r * r));
    let scene = Scene::new()
        .light(speck(1.0, 1.0))
        .light(speck(-1.0, 20.0))
        .light(speck(0.0, 300.0))
        .surface(floor(), white());
    let camera = spot(DVec3::new(0.0, -4.0, 1.0), DVec3::ZERO);
    let exact = 21.0 * 2.0 / 5f64.powf(1.5) + 300.0 / 4.0;
    let of = |samples, choice| {
        let strategy = Strategy { combination: Combination::Balance, choice, samples };
        only(&strategy.renderer(&scene, &camera, 64).render(1).unwrap())
    };
    for (samples, choice) in
        [(3, LightChoice::Uniform), (6, LightChoice::Uniform), (1, LightChoice::Each)]
    {
        let (value, error) = of([samples, 0], choice);
        assert_close(value, exact, 1e-8);
        assert!(error < 1e-8 * exact, "{samples} {choice:?}: {error}");
    }
    // Of another number, a part is left to chance.
    let (value, error) = of([2, 0], LightChoice::Uniform);
    assert!(error > 0.02 * exact && (value - exact).abs() < 5.0 * error, "{value} ± {error}");
}

#[test]
fn as_many_samples_as_lobes_take_each_once() {
    // Both lobes are alike: a single one of half the albedo each. In a furnace of which they see all,
    // each sample is worth the same. One of them alone sees half as much.
    let half = |albedo| Lambert::new(albedo).unwrap();
    let furnace = Scene::new().light(sphere_light(DVec3::ZERO, 50.0, 1.0));
    let scene = furnace.clone().surface(floor(), (half(0.2), half(0.4)));
    let picture = Strategy::BSDF.renderer(&scene, &from_above(2), 20).render(1).unwrap();
    assert!(picture.pixels().iter().all(|pixel| (pixel.value() - 0.6).abs() < 1e-15));
    // Where they differ, two samples of them vary less than twice as many single ones.
    let glossy = ModifiedPhong::new(0.5, 1e4).unwrap();
    let lamp = sphere_light(DVec3::new(0.0, 0.0, 7.0), 0.5, 1.0);
    let scene = Scene::new().light(lamp).surface(floor(), (half(0.0), glossy));
    let camera = spot(5.0 * DVec3::Z, DVec3::ZERO);
    // As good as all of the glossy lobe meets the lamp, the other adds nothing: V is I², or 0.
    let of = |samples, rays| {
        let strategy = Strategy { samples: [0, samples], ..Strategy::BSDF };
        let (value, error) = only(&strategy.renderer(&scene, &camera, rays).render(1).unwrap());
        assert!((value - 0.5).abs() < 5.0 * error + 1e-3, "{value} ± {error}");
        error * (rays as f64).sqrt() / value
    };
    let (one, two) = (of(1, 400), of(2, 400));
    assert!((0.9..1.1).contains(&one) && two < 0.05, "{one} {two}");
}
