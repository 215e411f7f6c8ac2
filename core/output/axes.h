// From the world of a scan (x right, y down, z forward) to the axes that a file format is read with. Signs and places change, numbers do
// not: what is written is exact, and no program has to know about a transform. Header only.
#pragma once

#include <Eigen/Core>

namespace hermite {

// x right, y up, z towards the first camera: glTF and OBJ.
inline Eigen::Vector3f y_up(const Eigen::Vector3f& v) { return {v.x(), -v.y(), -v.z()}; }

// x right, y forward, z up: LAS and STL.
inline Eigen::Vector3f z_up(const Eigen::Vector3f& v) { return {v.x(), v.z(), -v.y()}; }

// And back.
inline Eigen::Vector3f from_y_up(const Eigen::Vector3f& v) { return {v.x(), -v.y(), -v.z()}; }
inline Eigen::Vector3f from_z_up(const Eigen::Vector3f& v) { return {v.x(), -v.z(), v.y()}; }

}  // namespace hermite
