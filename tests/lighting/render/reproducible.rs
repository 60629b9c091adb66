//! The same bits for any number of threads and any window.

use super::{CHOICES, COMBINATIONS, Strategy, strategies};
use crate::support::sphere_light;
use mis::lighting::{
    Camera, Combination, DVec3, Lambert, LightChoice, ModifiedPhong, Pixel, PointLight, Rectangle,
    Scene, Sphere,
};

/// Two lobes, three lights, a shadow; lights and background in view.
fn scene() -> Scene<f64> {
    let floor = Rectangle::new(DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y).unwrap();
    let bsdf = (Lambert::new(0.3).unwrap(), ModifiedPhong::new(0.6, 50.0).unwrap());
    Scene::new()
        .light(sphere_light(DVec3::new(0.5, 0.4, 1.0), 0.3, 4.0))
        .light(sphere_light(DVec3::new(-0.5, 0.8, 0.7), 0.1, 30.0))
        .point_light(PointLight::new(DVec3::new(0.0, 1.0, 3.0), 2.0).unwrap())
        .surface(floor, bsdf)
        .occluder(Sphere::new(DVec3::new(0.2, 0.2, 0.4), 0.2).unwrap())
}

fn camera() -> Camera {
    let (eye, target) = (DVec3::new(0.0, -3.0, 2.0), DVec3::new(0.0, 0.3, 0.5));
    Camera::new(eye, target, DVec3::Z, 0.9, 11, 7).unwrap()
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let (scene, camera) = (scene(), camera());
    for strategy in strategies() {
        let renderer = strategy.renderer(&scene, &camera, 5);
        let one = renderer.render(5).unwrap();
        assert_eq!((one.width(), one.height(), one.pixels().len()), (11, 7, 77));
        for threads in [2, 4] {
            let more = renderer.clone().threads(threads).unwrap().render(5).unwrap();
            assert_eq!(one, more, "{strategy:?} on {threads} threads");
        }
        let other = renderer.render(6).unwrap();
        let sampled = |(a, b): &(&Pixel<f64>, _)| a.light_share().is_some() && a == b;
        assert_eq!(one.pixels().iter().zip(other.pixels()).filter(sampled).count(), 0);
        assert_ne!(one, other, "{strategy:?} with another seed");
    }
}

#[test]
fn tasks_of_a_part_of_a_row_or_of_a_pixel_are_put_together_in_order() {
    let (scene, camera) = (scene(), camera());
    for combination in [Combination::Balance, Combination::Optimal] {
        let strategy = Strategy { combination, choice: LightChoice::Power, samples: [1, 1] };
        // More rays than a task has, then one more than optimal weights are fitted to at once.
        for (rays, columns) in [(300, 0..11), (4097, 5..6)] {
            let renderer = strategy.renderer(&scene, &camera, rays);
            let renderer = renderer.window(columns.clone(), 5..6).unwrap();
            let one = renderer.render(5).unwrap();
            assert!(one.pixels().iter().all(|pixel| pixel.rays() == rays));
            let more = renderer.clone().threads(4).unwrap().render(5).unwrap();
            assert_eq!(one, more, "{combination:?}");
            let by_default = mis::lighting::Renderer::new(&scene, &camera);
            let by_default = by_default.combination(combination).light_choice(LightChoice::Power);
            let by_default = by_default.rays(rays).unwrap().window(columns, 5..6).unwrap();
            assert_eq!(one, by_default.render(5).unwrap(), "{combination:?}");
        }
    }
}

#[test]
fn a_pixel_is_the_same_in_any_window() {
    let (scene, camera) = (scene(), camera());
    for combination in COMBINATIONS {
        for choice in CHOICES {
            if (combination, choice) == (Combination::Constant, LightChoice::Each) {
                continue;
            }
            // More samples in a row of pixels than several blocks of the estimators have.
            let strategy = Strategy { combination, choice, samples: [37, 25] };
            let renderer = strategy.renderer(&scene, &camera, 9);
            let whole = renderer.render(8).unwrap();
            for (columns, rows) in [(3..7, 2..6), (0..11, 6..7), (10..11, 0..7), (4..5, 4..5)] {
                let part = renderer.clone().window(columns.clone(), rows.clone()).unwrap();
                let part = part.render(8).unwrap();
                assert_eq!((part.width(), part.height()), (columns.len(), rows.len()));
                for (y, row) in rows.enumerate() {
                    for (x, column) in columns.clone().enumerate() {
                        let (a, b) = (part.pixel(x, y), whole.pixel(column as usize, row as usize));
                        assert!(a.is_some());
                        assert_eq!(a, b, "{strategy:?}: {column}, {row}");
                    }
                }
                assert_eq!(part.pixel(part.width(), 0), None);
                assert_eq!(part.pixel(0, part.height()), None);
            }
        }
    }
}
