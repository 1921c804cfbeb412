#include "tape/contact/groups.hpp"

#include <algorithm>
#include <numeric>
#include <set>

#include "tape/core/error.hpp"

namespace tape {
namespace {
std::size_t at(int i) { return static_cast<std::size_t>(i); }
}  // namespace

ObjectGroups::ObjectGroups(const SurfaceMesh& mesh)
    : component_of_object(mesh.objects.size(), -1), parent_(mesh.objects.size()), fixed_(mesh.objects.size(), true) {
  std::iota(parent_.begin(), parent_.end(), 0);
  std::set<std::pair<int, int>> riders;  // object, block of the body that it rides
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const VertexOwner owner = mesh.owner[v];
    const int object = mesh.vertices[v].object;
    TAPE_CHECK(object >= 0 && object < objects());
    if (owner.block < 0) continue;
    fixed_[at(object)] = false;
    if (owner.body < 0 && owner.ride >= 0) riders.emplace(object, owner.ride_block);
    const std::size_t end = at(owner.block) + (owner.body < 0 ? 1 : 2);
    if (object_of_block.size() < end) object_of_block.resize(end, -1);
    const int other = object_of_block[at(owner.block)];
    if (other >= 0) parent_[at(root(object))] = root(other);  // one body carries both
    std::fill(object_of_block.begin() + owner.block, object_of_block.begin() + static_cast<std::ptrdiff_t>(end), object);
  }
  for (const JointlyMoved& joint : mesh.together) {
    if (joint.objects.empty()) continue;
    for (int object : joint.objects) parent_[at(root(object))] = root(joint.objects[0]);
    const std::size_t end = at(joint.first_block + joint.blocks);
    if (object_of_block.size() < end) object_of_block.resize(end, -1);
    std::fill_n(object_of_block.begin() + joint.first_block, joint.blocks, joint.objects[0]);
  }
  for (const auto& [a, b] : mesh.tied) join(a, b);
  for (const auto& [object, block] : riders)  // its path follows from both directions
    if (at(block) < object_of_block.size() && object_of_block[at(block)] >= 0) join(object, object_of_block[at(block)]);
  constant_parent_ = parent_;
  number_components();
}

int ObjectGroups::root(int object) {
  while (parent_[at(object)] != object) object = parent_[at(object)] = parent_[at(parent_[at(object)])];
  return object;
}

void ObjectGroups::join(int a, int b) {
  if (!fixed_[at(a)] && !fixed_[at(b)]) parent_[at(root(a))] = root(b);
}

void ObjectGroups::join(const std::vector<Real>& touching) {
  parent_ = constant_parent_;
  const int n = objects();
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      if (touching[at(a) * at(n) + at(b)] == 0) join(a, b);
  number_components();
}

void ObjectGroups::number_components() {
  components = 0;
  std::vector<int> number(parent_.size(), -1);
  for (int i = 0; i < objects(); ++i) {
    if (fixed_[at(i)]) continue;
    int& c = number[at(root(i))];
    if (c < 0) c = components++;
    component_of_object[at(i)] = c;
  }
}
}  // namespace tape
