// A result becomes a surface: mesh_of_result RESULT OUT.stl
#include <exception>
#include <iostream>
#include <stdexcept>

#include "core/dataset/text_file.h"
#include "core/dataset/trajectory.h"
#include "core/mesh/contour.h"
#include "core/output/ply.h"
#include "core/output/ply_reader.h"
#include "core/output/stl.h"

using namespace hermite;

int main(int count, char** arguments) try {
  if (count != 3)
    throw std::invalid_argument("give the folder of a result and a file for its surface");
  const std::string result = arguments[1];
  const dataset::Trajectory path =
      or_throw(dataset::read_tum_trajectory(result + "/trajectory.txt"));
  const output::PlyShape shape = or_throw(output::parse_ply(
      or_throw(dataset::read_text_file(result + "/surfels.ply", std::size_t{1} << 30))));
  const output::TriangleMesh mesh = or_throw(mesh::contour(output::cloud_of(shape), {}));
  or_throw(output::write_file_atomically(arguments[2], or_throw(output::format_stl(mesh))));
  std::cout << path.size() << " poses, " << shape.positions.size() << " surfels, "
            << mesh.triangles.size() << " triangles\n";
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
