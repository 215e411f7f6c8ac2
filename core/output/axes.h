// Conversion from the world of a scan (x right, y down, z forward) to the axes of a file format.
// Only signs and order change, so written values are exact, and other programs need no transform.
// Header only.
#pragma once

#include <Eigen/Core>

namespace hermite::output {

// x right, y up, z towards the first camera, for glTF and OBJ.
inline Eigen::Vector3f y_up(const Eigen::Vector3f& v) { return {v.x(), -v.y(), -v.z()}; }

// x right, y forward, z up, for LAS and STL.
inline Eigen::Vector3f z_up(const Eigen::Vector3f& v) { return {v.x(), v.z(), -v.y()}; }

// The inverse conversions.
inline Eigen::Vector3f from_y_up(const Eigen::Vector3f& v) { return {v.x(), -v.y(), -v.z()}; }
inline Eigen::Vector3f from_z_up(const Eigen::Vector3f& v) { return {v.x(), -v.z(), v.y()}; }

}  // namespace hermite::output
