// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>

#include "core/cloud/surface_map.hpp"
#include "core/segment/pixel_features.hpp"

namespace bpa::segment::detail {
namespace {

using Pixels = std::vector<std::int32_t>;  // indices

constexpr std::int32_t kNone = -1;

// Sets of pixels; the first pixel of a set is its root.
class PixelSets {
 public:
  explicit PixelSets(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::int32_t root(std::int32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::int32_t a, std::int32_t b) {
    const auto [first, second] = std::minmax({root(a), root(b)});
    parent_[second] = first;
  }

 private:
  std::vector<std::int32_t> parent_;
};

struct Connector {
  const SurfaceMap& map;
  const PixelFeatures& features;
  const Image<float>& edges;
  const Image<std::int32_t>& clusters;
  const SuperPixelOptions& options;
  const float strong_edge = static_cast<float>(options.strong_edge);
  const std::int32_t size = static_cast<std::int32_t>(map.size());
  PixelSets sets{map.size()};
  std::vector<std::uint8_t> labelled = std::vector<std::uint8_t>(map.size());

  Image<std::int32_t> run() {
    unite_cores();
    attach_strong_pixels();
    while (join_small_segments()) {
    }
    return numbered();
  }

  bool valid(std::int32_t i) const { return features[i].valid(); }
  bool strong(std::int32_t i) const { return edges[i] >= strong_edge; }
  float difference(std::int32_t a, std::int32_t b) const {
    return distance(features[a], features[b], inverse_spacing_squared(map, options, map.depth[a]));
  }

  // Calls visit(neighbour) for the four neighbours that have a normal.
  void for_each_neighbor(std::int32_t i, const auto& visit) const {
    const std::int32_t width = map.width(), u = i % width;
    if (u > 0 && valid(i - 1)) visit(i - 1);
    if (u + 1 < width && valid(i + 1)) visit(i + 1);
    if (i >= width && valid(i - width)) visit(i - width);
    if (i + width < size && valid(i + width)) visit(i + width);
  }

  // Pixels off the strong edges, as far as they hang together.
  void unite_cores() {
    for (std::int32_t i = 0; i < size; ++i) {
      if (!valid(i) || strong(i)) continue;
      labelled[i] = 1;
      for_each_neighbor(i, [&](std::int32_t j) {
        const bool ahead = j > i && !strong(j) && clusters[i] == clusters[j];
        if (ahead && !surface_breaks(map, i, j)) sets.unite(i, j);
      });
    }
  }

  // Pixels on strong edges join the most similar pixel beside them, of their own cluster rather
  // than of another, layer by layer from the edges' borders. What no layer reaches hangs together
  // by clusters.
  void attach_strong_pixels() {
    Pixels open;
    for (std::int32_t i = 0; i < size; ++i) {
      if (valid(i) && strong(i)) open.push_back(i);
    }
    std::vector<std::array<std::int32_t, 2>> joins;
    do {
      joins.clear();
      for (const std::int32_t i : open) {
        float best = std::numeric_limits<float>::max();
        std::int32_t partner = i;
        for_each_neighbor(i, [&](std::int32_t j) {
          if (!labelled[j] || surface_breaks(map, i, j)) return;
          const float other_cluster = clusters[i] == clusters[j] ? 0.0f : 1.0f;
          const float far = difference(i, j) + other_cluster;
          if (far < best) best = far, partner = j;
        });
        if (partner != i) joins.push_back({i, partner});
      }
      for (const auto& [pixel, partner] : joins) {
        sets.unite(pixel, partner);
        labelled[pixel] = 1;
      }
      std::erase_if(open, [&](std::int32_t i) { return labelled[i] != 0; });
    } while (!joins.empty());
    for (const std::int32_t i : open) {
      for_each_neighbor(i, [&](std::int32_t j) {
        const bool together = !labelled[j] && clusters[i] == clusters[j];
        if (together && !surface_breaks(map, i, j)) sets.unite(i, j);
      });
    }
  }

  // A segment that a small one may join.
  struct Contact {
    std::int32_t root = kNone;
    int count = 0;
    float difference = 0;  // sum
  };

  std::int32_t best_partner(const Pixels& pixels, std::int32_t own, const std::vector<int>& core) {
    std::vector<Contact> contacts;
    for (const std::int32_t i : pixels) {
      for_each_neighbor(i, [&](std::int32_t j) {
        const std::int32_t other = sets.root(j);
        if (other == own || surface_breaks(map, i, j)) return;
        const bool fringe = core[own] == 0 || core[other] == 0;
        if (!fringe && (strong(i) || strong(j))) return;
        auto found = std::ranges::find(contacts, other, &Contact::root);
        if (found == contacts.end()) found = contacts.insert(found, {other, 0, 0});
        ++found->count;
        found->difference += difference(i, j);
      });
    }
    std::int32_t best = kNone;
    float smallest = std::numeric_limits<float>::max();
    for (const Contact& contact : contacts) {
      const float mean = contact.difference / static_cast<float>(contact.count);
      if (mean < smallest) smallest = mean, best = contact.root;
    }
    return best;
  }

  // One round; whether anything was joined.
  bool join_small_segments() {
    std::vector<int> pixel_count(size, 0), core(size, 0);  // of the segment with that root
    for (std::int32_t i = 0; i < size; ++i) {
      if (!valid(i)) continue;
      ++pixel_count[sets.root(i)];
      core[sets.root(i)] += !strong(i);
    }
    std::map<std::int32_t, Pixels> small;  // by root
    for (std::int32_t i = 0; i < size; ++i) {
      if (valid(i) && pixel_count[sets.root(i)] < options.min_pixels)
        small[sets.root(i)].push_back(i);
    }
    bool joined = false;
    for (const auto& [root, pixels] : small) {
      // It may have been joined by a smaller one before; then the next round looks at it.
      if (sets.root(root) != root) continue;
      const std::int32_t partner = best_partner(pixels, root, core);
      if (partner == kNone) continue;
      const int cores = core[root] + core[partner];
      sets.unite(root, partner);
      core[sets.root(root)] = cores;
      joined = true;
    }
    return joined;
  }

  Image<std::int32_t> numbered() {
    Image<std::int32_t> labels(map.width(), map.height(), kNone);
    std::int32_t next = 0;
    for (std::int32_t i = 0; i < size; ++i) {
      if (!valid(i)) continue;
      const std::int32_t root = sets.root(i);
      labels[i] = root == i ? next++ : labels[root];
    }
    return labels;
  }
};

}  // namespace

Image<std::int32_t> connect(const SurfaceMap& map, const PixelFeatures& features,
                            const Image<float>& edges, const Image<std::int32_t>& clusters,
                            const SuperPixelOptions& options) {
  return Connector{map, features, edges, clusters, options}.run();
}

}  // namespace bpa::segment::detail
