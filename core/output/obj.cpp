#include "core/output/obj.h"

#include <fmt/core.h>

#include <charconv>

#include "core/output/axes.h"
#include "core/output/mesh_check.h"
#include "core/output/texture_jpeg.h"

namespace hermite::output {
namespace {

// Appends the shortest text that reads back as the same number, independent of the locale.
template <class Number>
void append_number(std::string& text, Number value) {
  char digits[64];
  const auto written = std::to_chars(digits, digits + sizeof digits, value);
  text.push_back(' ');
  text.append(digits, written.ptr);
}

void append_vertices(const TriangleMesh& mesh, std::string& text) {
  for (std::size_t i = 0; i < mesh.positions_m.size(); ++i) {
    text += "v";
    for (const float value : y_up(mesh.positions_m[i])) append_number(text, value);
    if (mesh.pages.empty())
      for (const std::uint8_t value : {mesh.colors[i].r, mesh.colors[i].g, mesh.colors[i].b})
        append_number(text, static_cast<float>(value) / 255);
    text += "\n";
  }
  for (const Eigen::Vector2f& at : mesh.texture_coordinates) {
    text += "vt";
    append_number(text, at.x());
    append_number(text, 1 - at.y());
    text += "\n";
  }
  for (const Eigen::Vector3f& normal : mesh.normals) {
    text += "vn";
    for (const float value : y_up(normal)) append_number(text, value);
    text += "\n";
  }
}

void append_faces(const TriangleMesh& mesh, std::size_t first, std::size_t count,
                  std::string& text) {
  for (std::size_t i = first; i < first + count; ++i) {
    text += "f";
    for (const std::uint32_t corner : mesh.triangles[i]) {
      std::string number;
      append_number(number, std::uint64_t{corner} + 1);
      text += number;
      number[0] = '/';
      text += mesh.pages.empty() ? "/" : number;
      text += number;
    }
    text += "\n";
  }
}

}  // namespace

Result<NamedFiles> format_obj(const TriangleMesh& mesh) {
  if (const Status status = check_mesh_with_triangles(mesh); !status.ok()) return status.error();
  NamedFiles files{{"mesh.obj", "# Hermite: metres, y up\n"}};
  std::string materials = "# Hermite: the light is in the texture already\n", text;
  if (!mesh.pages.empty()) text += "mtllib mesh.mtl\n";
  append_vertices(mesh, text);
  if (mesh.pages.empty()) append_faces(mesh, 0, mesh.triangles.size(), text);
  for (std::size_t i = 0; i < mesh.pages.size(); ++i) {
    const std::string name = "texture_" + std::to_string(i);
    const Result<std::string> jpeg = texture_jpeg(mesh.pages[i].image);
    if (!jpeg.ok()) return in_context(name, jpeg.error());
    files.push_back({name + ".jpg", *jpeg});
    materials += fmt::format("newmtl {}\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {}.jpg\n",
                             name, name);
    text += fmt::format("usemtl {}\n", name);
    append_faces(mesh, mesh.pages[i].first_triangle, mesh.pages[i].triangle_count, text);
  }
  files[0].bytes += text;
  if (!mesh.pages.empty()) files.push_back({"mesh.mtl", materials});
  return files;
}

}  // namespace hermite::output
