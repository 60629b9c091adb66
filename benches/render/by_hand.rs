//! The scene of the benchmark as a loop of its own, in f64, that knows nothing but this scene: a floor
//! of microfacets, a sphere and a rectangle as lights. One camera ray for each pixel, then samples of
//! the lights in turn and of the floor's visible normals, combined by the balance heuristic; whatever
//! does not change is computed once for each pixel.

use std::f64::consts::{PI, TAU};

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

type V = [f64; 3];

const SPHERE: (V, f64, f64) = ([0.9, 0.8, 0.9], 0.25, 5.0);
/// Centre, half extents, radiance.
const CEILING: (V, [f64; 2], f64) = ([-0.8, 0.7, 1.1], [0.35, 0.25], 8.0);
const EYE: V = [0.0, -3.2, 1.6];
const ALPHA: f64 = 0.1;

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn times(s: f64, a: V) -> V {
    [s * a[0], s * a[1], s * a[2]]
}

fn unit(a: V) -> V {
    times(1.0 / dot(a, a).sqrt(), a)
}

fn uniform(generator: &mut Pcg64Mcg) -> f64 {
    ((generator.next_u64() >> 12) as f64 + 0.5) * 2f64.powi(-52)
}

/// G1 / cos θ.
fn masking_over_cos(w: V) -> f64 {
    2.0 / (w[2] + (w[2] * w[2] + ALPHA * ALPHA * (w[0] * w[0] + w[1] * w[1])).sqrt())
}

/// What is the same for all samples of a pixel: a point of the floor, which is at z = 0 and has its
/// normal along z, and what is seen from there.
struct Point {
    v: V,
    /// G1(v) / (4 cos θ_v).
    factor: f64,
    axis: V,
    side: [V; 2],
    /// 1 - cos of the sphere's cone, and the distance of its centre.
    width: f64,
    distance: f64,
    sphere_pdf: f64,
    /// The ceiling in coordinates about p: its corners, and what the sampling of its solid angle needs
    /// (Ureña, Fajardo and King 2013).
    x: [f64; 2],
    y: [f64; 2],
    b: [f64; 2],
    k: f64,
    solid_angle: f64,
    ceiling_pdf: f64,
}

impl Point {
    fn new(p: V, v: V) -> Self {
        let to_sphere = sub(SPHERE.0, p);
        let d2 = dot(to_sphere, to_sphere);
        let sin2 = SPHERE.1 * SPHERE.1 / d2;
        let width = sin2 / (1.0 + (1.0 - sin2).sqrt());
        let axis = times(1.0 / d2.sqrt(), to_sphere);
        let sign = 1f64.copysign(axis[2]);
        let a = -1.0 / (sign + axis[2]);
        let b = axis[0] * axis[1] * a;
        let side = [
            [1.0 + sign * axis[0] * axis[0] * a, sign * b, -sign * axis[0]],
            [b, sign + axis[1] * axis[1] * a, -axis[1]],
        ];
        let (centre, half, _) = CEILING;
        let x = [centre[0] - half[0] - p[0], centre[0] + half[0] - p[0]];
        let y = [centre[1] - half[1] - p[1], centre[1] + half[1] - p[1]];
        let z = centre[2];
        // The z components of the normals of the planes through an edge.
        let n = [
            -y[0] / (z * z + y[0] * y[0]).sqrt(),
            x[1] / (z * z + x[1] * x[1]).sqrt(),
            y[1] / (z * z + y[1] * y[1]).sqrt(),
            -x[0] / (z * z + x[0] * x[0]).sqrt(),
        ];
        let g: [f64; 4] = std::array::from_fn(|i| (-n[i] * n[(i + 1) % 4]).acos());
        let k = TAU - g[2] - g[3];
        let solid_angle = g[0] + g[1] - k;
        Self {
            v,
            factor: 0.25 * masking_over_cos(v),
            axis,
            side,
            width,
            distance: d2.sqrt(),
            sphere_pdf: 0.5 / (TAU * width),
            x,
            y,
            b: [n[0], n[2]],
            k,
            solid_angle,
            ceiling_pdf: 0.5 / solid_angle,
        }
    }

    fn to_sphere(&self, u: f64, turn: f64) -> V {
        let q = u * self.width;
        let sin = (q * (2.0 - q)).sqrt();
        let (sin_phi, cos_phi) = (TAU * turn).sin_cos();
        let (cos, a, b) = (1.0 - q, sin * cos_phi, sin * sin_phi);
        std::array::from_fn(|i| cos * self.axis[i] + a * self.side[0][i] + b * self.side[1][i])
    }

    fn to_ceiling(&self, u: f64, v: f64) -> V {
        let z = CEILING.0[2];
        let au = u * self.solid_angle + self.k;
        let fu = (au.cos() * self.b[0] - self.b[1]) / au.sin();
        let cu = (1.0 / (fu * fu + self.b[0] * self.b[0]).sqrt()).copysign(fu);
        let xu = (-(cu * -z) / (1.0 - cu * cu).sqrt()).clamp(self.x[0], self.x[1]);
        let d2 = xu * xu + z * z;
        let [h0, h1] = self.y.map(|y| y / (d2 + y * y).sqrt());
        let hv = h0 + v * (h1 - h0);
        let yv = if hv * hv < 1.0 - 1e-12 { hv * (d2 / (1.0 - hv * hv)).sqrt() } else { self.y[1] };
        unit([xu, yv, z])
    }

    /// A mirror direction of a visible normal (Dupuy and Benyoub 2023).
    fn off_floor(&self, u: f64, turn: f64) -> V {
        let v = unit([ALPHA * self.v[0], ALPHA * self.v[1], self.v[2]]);
        let z = 1.0 - u * (1.0 + v[2]);
        let sin = (1.0 - z * z).sqrt();
        let (sin_phi, cos_phi) = (TAU * turn).sin_cos();
        let m = [ALPHA * (sin * cos_phi + v[0]), ALPHA * (sin * sin_phi + v[1]), z + v[2]];
        let m = unit(m);
        sub(times(2.0 * dot(self.v, m), m), self.v)
    }

    fn sphere_hit(&self, w: V) -> Option<f64> {
        let d = sub(w, self.axis);
        let q = 0.5 * dot(d, d);
        if q > self.width {
            return None;
        }
        let r2 = SPHERE.1 * SPHERE.1;
        let along = self.distance * (1.0 - q);
        let d2 = self.distance * self.distance;
        Some((d2 - r2) / (along + (r2 - d2 * q * (2.0 - q)).max(0.0).sqrt()))
    }

    fn ceiling_hit(&self, w: V) -> Option<f64> {
        let t = CEILING.0[2] / w[2];
        let (x, y) = (t * w[0], t * w[1]);
        (x >= self.x[0] && x <= self.x[1] && y >= self.y[0] && y <= self.y[1]).then_some(t)
    }

    /// f L / (16 p_lights + 16 p_bsdf), without the 16.
    fn contribution(&self, w: V) -> f64 {
        if w[2] <= 0.0 {
            return 0.0;
        }
        let (sphere, ceiling) = (self.sphere_hit(w), self.ceiling_hit(w));
        let (radiance, lights) = match (sphere, ceiling) {
            (None, None) => return 0.0,
            (Some(_), None) => (SPHERE.2, self.sphere_pdf),
            (None, Some(_)) => (CEILING.2, self.ceiling_pdf),
            (Some(s), Some(c)) => {
                (if s < c { SPHERE.2 } else { CEILING.2 }, self.sphere_pdf + self.ceiling_pdf)
            }
        };
        let m = [self.v[0] + w[0], self.v[1] + w[1], self.v[2] + w[2]];
        let m = unit(m);
        let k = (m[0] * m[0] + m[1] * m[1]) / (ALPHA * ALPHA) + m[2] * m[2];
        let bsdf = self.factor / (PI * ALPHA * ALPHA * k * k);
        radiance * bsdf * masking_over_cos(w) * w[2] / (lights + bsdf)
    }
}

/// The mean radiance of a picture of `size` by `size` pixels, with so many rays for each, and `each`
/// samples of the lights and of the BSDF for each ray: of one light and the other in turn, or by chance
/// if there is only one.
pub(crate) fn render(size: u32, rays: u64, each: u64, seed: u64) -> f64 {
    let mut generator = Pcg64Mcg::seed_from_u64(seed);
    let camera = Eye::new(size);
    let mut picture = vec![0.0; (size * size) as usize];
    for (pixel, number) in picture.iter_mut().zip(0..) {
        let mut sum = 0.0;
        for _ in 0..rays {
            let (x, y) = (uniform(&mut generator), uniform(&mut generator));
            let ray = camera.ray(f64::from(number % size) + x, f64::from(number / size) + y);
            let point = match camera.seen(ray) {
                Ok(point) => point,
                Err(radiance) => {
                    sum += radiance;
                    continue;
                }
            };
            let mut samples = 0.0;
            for k in 0..each {
                let sphere = if each == 1 { uniform(&mut generator) < 0.5 } else { k % 2 == 0 };
                let (u, v) = (uniform(&mut generator), uniform(&mut generator));
                let w = if sphere { point.to_sphere(u, v) } else { point.to_ceiling(u, v) };
                samples += point.contribution(w);
            }
            for _ in 0..each {
                let w = point.off_floor(uniform(&mut generator), uniform(&mut generator));
                samples += point.contribution(w);
            }
            sum += samples / each as f64;
        }
        *pixel = sum / rays as f64;
    }
    picture.iter().sum::<f64>() / f64::from(size * size)
}

struct Eye {
    forward: V,
    left: V,
    up: V,
    size: f64,
}

impl Eye {
    fn new(size: u32) -> Self {
        let forward = unit(sub([0.0, 0.3, 0.0], EYE));
        let left = unit([-forward[1], forward[0], 0.0]);
        let up = [
            forward[1] * left[2] - forward[2] * left[1],
            forward[2] * left[0] - forward[0] * left[2],
            forward[0] * left[1] - forward[1] * left[0],
        ];
        let t = 20_f64.to_radians().tan();
        Self { forward, left: times(t, left), up: times(t, up), size: f64::from(size) }
    }

    fn ray(&self, x: f64, y: f64) -> V {
        let (sx, sy) = (1.0 - 2.0 * x / self.size, 1.0 - 2.0 * y / self.size);
        unit(std::array::from_fn(|i| self.forward[i] + sx * self.left[i] + sy * self.up[i]))
    }

    /// The point of the floor that a ray meets, or the radiance of what is in front or beside.
    fn seen(&self, ray: V) -> Result<Point, f64> {
        let to_sphere = sub(SPHERE.0, EYE);
        let along = dot(to_sphere, ray);
        let chord2 = SPHERE.1 * SPHERE.1 - dot(to_sphere, to_sphere) + along * along;
        if chord2 >= 0.0 {
            return Err(SPHERE.2);
        }
        // The ceiling is black from above.
        let [cx, cy, cz] = sub(CEILING.0, EYE);
        let s = cz / ray[2];
        let behind = s > 0.0
            && (s * ray[0] - cx).abs() <= CEILING.1[0]
            && (s * ray[1] - cy).abs() <= CEILING.1[1];
        let distance = -EYE[2] / ray[2];
        let p = [EYE[0] + distance * ray[0], EYE[1] + distance * ray[1], 0.0];
        if behind || ray[2] >= 0.0 || p[0].abs() > 2.0 || p[1].abs() > 2.0 {
            return Err(0.0);
        }
        Ok(Point::new(p, times(-1.0, ray)))
    }
}
