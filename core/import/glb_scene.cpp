#include "core/import/glb_scene.h"

#include <fmt/core.h>

#include <Eigen/Geometry>

#include <optional>

namespace hermite::imports {
namespace {

using Json = nlohmann::json;

struct Visit {
  std::uint64_t node = 0;
  std::size_t depth = 0;
  Eigen::Matrix4d world_from_parent = Eigen::Matrix4d::Identity();
};

std::string name_of_node(std::uint64_t index) { return fmt::format("nodes[{}]", index); }

// Reads an array of node indices.
Result<std::vector<std::uint64_t>> node_list(const Json& object, const char* key,
                                             const std::string& where) {
  std::vector<std::uint64_t> nodes;
  const auto found = object.find(key);
  if (found == object.end()) return nodes;
  if (!found->is_array() || found->size() > kMaxGlbObjects)
    return glb_error(fmt::format("{}.{} is not an array of nodes", where, key));
  for (const Json& node : *found) {
    if (!node.is_number_unsigned())
      return glb_error(fmt::format("{}.{} has an entry that is not a node index", where, key));
    nodes.push_back(node.get<std::uint64_t>());
  }
  return nodes;
}

Result<Eigen::Matrix4d> parent_from_node(const Json& node, const std::string& where) {
  const auto matrix = glb_numbers(node, "matrix", 16, where),
             translation = glb_numbers(node, "translation", 3, where),
             rotation = glb_numbers(node, "rotation", 4, where),
             scale = glb_numbers(node, "scale", 3, where);
  for (const auto* field : {&matrix, &translation, &rotation, &scale})
    if (!field->ok()) return field->error();
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  if (*matrix) {
    result = Eigen::Map<const Eigen::Matrix4d>((*matrix)->data());
    result.row(3) = Eigen::RowVector4d(0, 0, 0, 1);
    return result;
  }
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  if (*rotation)
    turn = Eigen::Quaterniond((**rotation)[3], (**rotation)[0], (**rotation)[1], (**rotation)[2]);
  if (!(turn.norm() > 1e-6)) return glb_error(where + ".rotation is a quaternion of length 0");
  result.topLeftCorner<3, 3>() = turn.normalized().toRotationMatrix();
  if (*scale)
    result.topLeftCorner<3, 3>() *=
        Eigen::Map<const Eigen::Vector3d>((*scale)->data()).asDiagonal();
  if (*translation)
    result.topRightCorner<3, 1>() = Eigen::Map<const Eigen::Vector3d>((*translation)->data());
  return result;
}

Result<std::vector<std::uint64_t>> root_nodes(const GlbDocument& document) {
  const auto scene = glb_index(document.json(), "scene", "glTF");
  if (!scene.ok()) return scene.error();
  if (*scene || document.count("scenes") > 0) {
    const Result<const Json*> object = document.object("scenes", scene->value_or(0));
    if (!object.ok()) return object.error();
    return node_list(**object, "nodes", fmt::format("scenes[{}]", scene->value_or(0)));
  }
  std::vector<bool> is_child(document.count("nodes"), false);
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    const auto children = node_list(**document.object("nodes", i), "children", name_of_node(i));
    if (!children.ok()) return children.error();
    for (const std::uint64_t child : *children)
      if (child < is_child.size()) is_child[static_cast<std::size_t>(child)] = true;
  }
  std::vector<std::uint64_t> roots;
  for (std::size_t i = 0; i < is_child.size(); ++i)
    if (!is_child[i]) roots.push_back(i);
  return roots;
}

// The nodes still to be visited; each is visited once.
class Walk {
 public:
  explicit Walk(std::size_t node_count) : seen_(node_count, false) {}

  Status add(const std::vector<std::uint64_t>& nodes, std::size_t depth,
             const Eigen::Matrix4d& world_from_parent) {
    if (!nodes.empty() && depth > kMaxGlbNodeDepth)
      return glb_error("nodes are nested deeper than " + std::to_string(kMaxGlbNodeDepth));
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
      if (*node >= seen_.size())
        return glb_error(
            fmt::format("there is no {}, there are {}", name_of_node(*node), seen_.size()));
      if (seen_[static_cast<std::size_t>(*node)])
        return glb_error(name_of_node(*node) + " is below itself, or below two others");
      seen_[static_cast<std::size_t>(*node)] = true;
      waiting_.push_back({*node, depth, world_from_parent});
    }
    return Done{};
  }
  std::optional<Visit> next() {
    if (waiting_.empty()) return std::nullopt;
    const Visit visit = waiting_.back();
    waiting_.pop_back();
    return visit;
  }

 private:
  std::vector<bool> seen_;
  std::vector<Visit> waiting_;
};

Status look_at(const GlbDocument& document, const Visit& at, Walk& walk,
               std::vector<GlbPlacement>& placements) {
  const std::string where = name_of_node(at.node);
  const Json& node = **document.object("nodes", at.node);
  const Result<Eigen::Matrix4d> own = parent_from_node(node, where);
  if (!own.ok()) return own.error();
  const Eigen::Matrix4d world_from_node = at.world_from_parent * *own;
  if (!world_from_node.allFinite()) return glb_error(where + " has a transform that is not finite");
  const auto mesh = glb_index(node, "mesh", where);
  if (!mesh.ok()) return mesh.error();
  if (*mesh) placements.push_back({**mesh, world_from_node});
  const Result<std::vector<std::uint64_t>> children = node_list(node, "children", where);
  return children.ok() ? walk.add(*children, at.depth + 1, world_from_node)
                       : Status(children.error());
}

}  // namespace

Result<std::vector<GlbPlacement>> glb_placements(const GlbDocument& document) {
  const Result<std::vector<std::uint64_t>> roots = root_nodes(document);
  if (!roots.ok()) return roots.error();
  Walk walk(document.count("nodes"));
  if (const Status added = walk.add(*roots, 0, Eigen::Matrix4d::Identity()); !added.ok())
    return added.error();
  std::vector<GlbPlacement> placements;
  while (const std::optional<Visit> at = walk.next())
    if (const Status looked = look_at(document, *at, walk, placements); !looked.ok())
      return looked.error();
  if (placements.empty()) return glb_error("no node of the scene has a mesh");
  return placements;
}

}  // namespace hermite::imports
