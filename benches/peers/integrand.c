#include "integrand.h"

#include <math.h>

static const double TAU = 6.283185307179586476925286766559;

void integrand_prepare(struct integrand *f)
{
    const double *p = f->p;
    size_t d = f->d;
    switch (f->kind) {
    case 2:
        for (size_t i = 0; i < d; i++)
            f->c[i] = 1 / (p[i] * p[i]);
        break;
    case 4:
        for (size_t i = 0; i < d; i++)
            f->c[i] = p[i] * p[i];
        break;
    case 7:
        for (size_t k = 0; k < (size_t)p[0]; k++) {
            double w = p[1 + 3 * k], s = p[3 + 3 * k];
            f->c[2 * k] = w * pow(TAU * s * s, -0.5 * (double)d);
            f->c[2 * k + 1] = -0.5 / (s * s);
        }
        break;
    case 9:
        f->c[0] = 1 / (TAU * p[0] * p[0] * 0.5 * TAU * p[1] * p[1]);
        f->c[1] = -0.5 / (p[0] * p[0]);
        f->c[2] = p[1] * p[1];
        break;
    }
}

double integrand_eval(const struct integrand *f, const double *x)
{
    const double *p = f->p, *c = f->c, *u = f->p + f->d;
    size_t d = f->d;
    double sum = 0, product = 1;
    switch (f->kind) {
    case 0:
        return p[0] * sin(p[0] * x[0]) * cos(p[0] * x[0]);
    case 1:
        sum = TAU * u[0];
        for (size_t i = 0; i < d; i++)
            sum += p[i] * x[i];
        return cos(sum);
    case 2:
        for (size_t i = 0; i < d; i++)
            product *= c[i] + (x[i] - u[i]) * (x[i] - u[i]);
        return 1 / product;
    case 4:
        for (size_t i = 0; i < d; i++)
            sum += c[i] * (x[i] - u[i]) * (x[i] - u[i]);
        return exp(-sum);
    case 5:
        for (size_t i = 0; i < d; i++)
            sum += p[i] * fabs(x[i] - u[i]);
        return exp(-sum);
    case 7:
        for (size_t k = 0; k < (size_t)p[0]; k++) {
            double centre = p[2 + 3 * k], r2 = 0;
            for (size_t i = 0; i < d; i++)
                r2 += (x[i] - centre) * (x[i] - centre);
            sum += c[2 * k] * exp(c[2 * k + 1] * r2);
        }
        return sum;
    case 9: {
        double dx = x[0] - p[4], dy = x[1] - p[5];
        if (!(dx * dx + dy * dy < c[2]))
            return 0;
        dx = x[0] - p[2], dy = x[1] - p[3];
        return c[0] * exp(c[1] * (dx * dx + dy * dy));
    }
    }
    return NAN;
}

void integrand_eval_batch(const struct integrand *f, const double *x, size_t n, double *y)
{
    for (size_t i = 0; i < n; i++)
        y[i] = integrand_eval(f, x + i * f->d);
}
