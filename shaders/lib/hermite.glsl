// The closed-form Hermite RBF implicit function of oriented points (paper section 3), at four
// points x at once. core/math/hrbf.h is the same in double precision, and
// tests/core/frame/hermite_test.cpp compares the two.
//
// A kernel is a point p with a support of radius r and a unit normal n away from the camera. With
// v = x - p, rho = |v| / r, s = 1 - rho inside the support and 0 outside, and u = n . v:
//
//   psi    = s^4 (4 rho + 1),  grad psi = -20 s^3 v / r^2                        Eq. 2
//   f      = -sum C n . grad psi = sum a s^3 u,  a = 20 C / r^2                  Eq. 3, with
//            C = 10 for r^2 / (20 + eta r^2)
//   grad f = sum a (s^3 n - 3 q u v / r^2),  q = s^2 / rho
//   Hess f = -sum 3 a / r^2 (q (n v^T + v n^T + u I) - c v v^T),  c = (1 / rho^2 - 1) u / (rho r^2)
//
// core/METHOD.md ("Coefficient") explains why C is constant. Each of the functions that add takes
// one kernel, and its `share` or `weight` for each of the four points; 0 leaves it out.
const float kAmplitude = 200.0;  // 20 C

struct Kernel {
  vec3 position, normal;
  float inverse_radius;
};

// A kernel relative to the four points.
struct Offset4 {
  Vectors4 v;
  vec4 rho;
};

struct Hessian4 {
  vec4 xx, yy, zz, xy, xz, yz;
};

Offset4 offset_from(Kernel k, Vectors4 x) {
  Vectors4 v = minus(x, k.position);
  return Offset4(v, sqrt(square4(v)) * k.inverse_radius);
}

// Returns 1 where the support reaches, else 0.
vec4 reaches(Offset4 o) { return vec4(lessThan(o.rho, vec4(1.0))); }

// Eq. 3.
void add_value(inout vec4 f, Kernel k, Offset4 o, vec4 share) {
  vec4 s = 1.0 - o.rho, u = dot4(o.v, k.normal);
  f += share * (kAmplitude * k.inverse_radius * k.inverse_radius) * reaches(o) * s * s * s * u;
}

// At the kernel's own centre the direction is undefined, but its term has no weight there.
vec4 inverse_rho(Offset4 o) { return 1.0 / max(o.rho, 1e-6); }

// The gradient of Eq. 3.
void add_gradient(inout Vectors4 gradient, Kernel k, Offset4 o, vec4 share) {
  float inverse_r2 = k.inverse_radius * k.inverse_radius;
  vec4 a = share * reaches(o) * (kAmplitude * inverse_r2);
  vec4 s = 1.0 - o.rho, u = dot4(o.v, k.normal), q = s * s * inverse_rho(o);
  vec4 toward_normal = a * s * s * s, along = a * (3.0 * inverse_r2) * q * u;
  gradient.x += toward_normal * k.normal.x - along * o.v.x;
  gradient.y += toward_normal * k.normal.y - along * o.v.y;
  gradient.z += toward_normal * k.normal.z - along * o.v.z;
}

// The Hessian of Eq. 3. It is discontinuous at the kernel's own centre, so a point's own kernel
// must be left out (core/METHOD.md, "Hessian").
void add_hessian(inout Hessian4 hessian, Kernel k, Offset4 o, vec4 share) {
  float inverse_r2 = k.inverse_radius * k.inverse_radius;
  vec3 n = k.normal;
  vec4 s = 1.0 - o.rho, u = dot4(o.v, n), q = s * s * inverse_rho(o);
  vec4 c = (inverse_rho(o) * inverse_rho(o) - 1.0) * inverse_rho(o) * inverse_r2 * u;
  vec4 h = share * reaches(o) * (kAmplitude * inverse_r2) * (-3.0 * inverse_r2);
  hessian.xx += h * (q * (2.0 * n.x * o.v.x + u) - c * o.v.x * o.v.x);
  hessian.yy += h * (q * (2.0 * n.y * o.v.y + u) - c * o.v.y * o.v.y);
  hessian.zz += h * (q * (2.0 * n.z * o.v.z + u) - c * o.v.z * o.v.z);
  hessian.xy += h * (q * (n.x * o.v.y + n.y * o.v.x) - c * o.v.x * o.v.y);
  hessian.xz += h * (q * (n.x * o.v.z + n.z * o.v.x) - c * o.v.x * o.v.z);
  hessian.yz += h * (q * (n.y * o.v.z + n.z * o.v.y) - c * o.v.y * o.v.z);
}

// Step along the ray (core/METHOD.md). Along x = t d, Eq. 3 is a mean of the distances from the
// kernels' planes, weighted by w = s^3 / r^2; its zero is near t = sum w n.p / sum w n.d.
struct Step4 {
  vec4 plane, slope;
};
vec4 step_weight(Kernel k, Offset4 o) {
  vec4 s = max(1.0 - o.rho, 0.0);
  return s * s * s * (k.inverse_radius * k.inverse_radius);
}
void add_plane(inout Step4 sums, vec4 weight, vec4 plane, vec4 slope) {
  sums.plane += weight * plane;
  sums.slope += weight * slope;
}
// Returns the step, or `otherwise` where no kernel reaches.
vec4 step_to(Step4 sums, vec4 otherwise) {
  return mix(otherwise, sums.plane / sums.slope, greaterThan(sums.slope, vec4(0.0)));
}

// Returns kappa = H +- sqrt(H^2 - K) of a level set with mean curvature H and Gaussian curvature K
// (Eq. 4; the paper's K lacks the minus sign before the determinant). g, d and m: gradient,
// diagonal (xx yy zz) and mixed (xy xz yz) second derivatives. Surfaces that bulge towards the
// camera have positive curvature.
vec2 principal_curvatures(vec3 g, vec3 d, vec3 m) {
  float g2 = max(dot(g, g), 1e-30);
  vec3 hg = vec3(d.x * g.x + m.x * g.y + m.y * g.z, m.x * g.x + d.y * g.y + m.z * g.z,
                 m.y * g.x + m.z * g.y + d.z * g.z);
  float mean = (dot(g, hg) - g2 * (d.x + d.y + d.z)) / (2.0 * g2 * sqrt(g2));
  // g^T adj(Hessian) g
  vec3 cofactor_diagonal =
      vec3(d.y * d.z - m.z * m.z, d.x * d.z - m.y * m.y, d.x * d.y - m.x * m.x);
  vec3 cofactor_mixed = vec3(m.y * m.z - m.x * d.z, m.x * m.z - m.y * d.y, m.x * m.y - m.z * d.x);
  float gaussian =
      (dot(cofactor_diagonal, g * g) + 2.0 * dot(cofactor_mixed, g.xxy * g.yzz)) / (g2 * g2);
  float root = sqrt(max(0.0, mean * mean - gaussian));
  return vec2(mean + root, mean - root);
}

// Returns c_r (Eq. 5, with the square root for which its constant is meant): how densely and
// consistently the surface is sampled. `gradient` is the component along the pixel's previous
// normal.
float reconstruction_confidence(float gradient, float epsilon) {
  return exp(-epsilon * inversesqrt(max(gradient, 1e-6)));
}
