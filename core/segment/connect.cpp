// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "core/cloud/surface_break.hpp"
#include "core/segment/pixel_features.hpp"

namespace bpa::detail {
namespace {

constexpr std::int32_t kNone = -1;

// Sets of pixels; the first pixel of a set is its root.
class PixelSets {
 public:
  explicit PixelSets(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::int32_t root(std::size_t i) {
    auto at = static_cast<std::int32_t>(i);
    while (parent(at) != at) {
      parent(at) = parent(parent(at));
      at = parent(at);
    }
    return at;
  }
  void unite(std::size_t a, std::size_t b) {
    const std::int32_t first = root(a), second = root(b);
    parent(std::max(first, second)) = std::min(first, second);
  }

 private:
  std::int32_t& parent(std::int32_t i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<std::int32_t> parent_;
};

class Connector {
 public:
  Connector(const SurfaceMap& map, const PixelFeatures& features, const Image<float>& edges,
            const Image<std::int32_t>& clusters, const SuperPixelOptions& options)
      : map_(map),
        features_(features),
        edges_(edges),
        clusters_(clusters),
        options_(options),
        strong_(static_cast<float>(options.strong_edge)),
        sets_(map.size()),
        labelled_(map.size(), 0) {}

  Image<std::int32_t> run() {
    unite_cores();
    attach_strong_pixels();
    while (join_small_segments()) {
    }
    return numbered();
  }

 private:
  bool valid(std::size_t i) const { return features_[i].valid(); }
  bool strong(std::size_t i) const { return edges_[i] >= strong_; }
  float difference(std::size_t a, std::size_t b) const {
    return distance(features_[a], features_[b],
                    inverse_spacing_squared(map_, options_, map_.depth[a]));
  }

  // Calls visit(neighbour) for the four neighbours that have a normal.
  template <class Visit>
  void for_each_neighbor(std::size_t i, const Visit& visit) const {
    const auto width = static_cast<std::size_t>(map_.width());
    const std::size_t u = i % width;
    if (u > 0 && valid(i - 1)) visit(i - 1);
    if (u + 1 < width && valid(i + 1)) visit(i + 1);
    if (i >= width && valid(i - width)) visit(i - width);
    if (i + width < map_.size() && valid(i + width)) visit(i + width);
  }

  // Pixels off the strong edges, as far as they hang together.
  void unite_cores() {
    for (std::size_t i = 0; i < map_.size(); ++i) {
      if (!valid(i) || strong(i)) continue;
      labelled_[i] = 1;
      for_each_neighbor(i, [&](std::size_t j) {
        const bool ahead = j > i && !strong(j) && clusters_[i] == clusters_[j];
        if (ahead && !surface_breaks(map_, i, j)) sets_.unite(i, j);
      });
    }
  }

  // Pixels on strong edges join the most similar pixel beside them, of their own cluster rather
  // than of another, layer by layer from the edges' borders. What no layer reaches hangs together
  // by clusters.
  void attach_strong_pixels() {
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < map_.size(); ++i) {
      if (valid(i) && strong(i)) open.push_back(i);
    }
    std::vector<std::array<std::size_t, 2>> joins;
    do {
      joins.clear();
      for (const std::size_t i : open) {
        float best = std::numeric_limits<float>::max();
        std::size_t partner = i;
        for_each_neighbor(i, [&](std::size_t j) {
          if (!labelled_[j] || surface_breaks(map_, i, j)) return;
          const float other_cluster = clusters_[i] == clusters_[j] ? 0.0f : 1.0f;
          const float far = difference(i, j) + other_cluster;
          if (far < best) best = far, partner = j;
        });
        if (partner != i) joins.push_back({i, partner});
      }
      for (const auto& [pixel, partner] : joins) {
        sets_.unite(pixel, partner);
        labelled_[pixel] = 1;
      }
      std::erase_if(open, [&](std::size_t i) { return labelled_[i] != 0; });
    } while (!joins.empty());
    for (const std::size_t i : open) {
      for_each_neighbor(i, [&](std::size_t j) {
        const bool together = !labelled_[j] && clusters_[i] == clusters_[j];
        if (together && !surface_breaks(map_, i, j)) sets_.unite(i, j);
      });
    }
  }

  // A segment that a small one may join.
  struct Contact {
    std::int32_t root = kNone;
    int count = 0;
    float difference = 0;  // sum
  };

  std::int32_t best_partner(const std::vector<std::size_t>& pixels, std::int32_t own,
                            const std::vector<int>& core) {
    std::vector<Contact> contacts;
    for (const std::size_t i : pixels) {
      for_each_neighbor(i, [&](std::size_t j) {
        const std::int32_t other = sets_.root(j);
        if (other == own || surface_breaks(map_, i, j)) return;
        const bool fringe =
            core[static_cast<std::size_t>(own)] == 0 || core[static_cast<std::size_t>(other)] == 0;
        if (!fringe && (strong(i) || strong(j))) return;
        auto found = std::find_if(contacts.begin(), contacts.end(),
                                  [other](const Contact& c) { return c.root == other; });
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
    std::vector<int> size(map_.size(), 0), core(map_.size(), 0);
    for (std::size_t i = 0; i < map_.size(); ++i) {
      if (!valid(i)) continue;
      const auto root = static_cast<std::size_t>(sets_.root(i));
      ++size[root];
      core[root] += !strong(i);
    }
    std::vector<std::vector<std::size_t>> small;
    std::vector<std::int32_t> place(map_.size(), kNone);
    for (std::size_t i = 0; i < map_.size(); ++i) {
      if (!valid(i)) continue;
      const auto root = static_cast<std::size_t>(sets_.root(i));
      if (size[root] >= options_.min_pixels) continue;
      if (place[root] == kNone) {
        place[root] = static_cast<std::int32_t>(small.size());
        small.emplace_back();
      }
      small[static_cast<std::size_t>(place[root])].push_back(i);
    }
    bool joined = false;
    for (const std::vector<std::size_t>& pixels : small) {
      const std::int32_t own = sets_.root(pixels.front());
      // It may have been joined by a smaller one before; then the next round looks at it.
      if (static_cast<std::size_t>(own) != pixels.front()) continue;
      const std::int32_t partner = best_partner(pixels, own, core);
      if (partner == kNone) continue;
      const int cores =
          core[static_cast<std::size_t>(own)] + core[static_cast<std::size_t>(partner)];
      sets_.unite(pixels.front(), static_cast<std::size_t>(partner));
      core[static_cast<std::size_t>(sets_.root(pixels.front()))] = cores;
      joined = true;
    }
    return joined;
  }

  Image<std::int32_t> numbered() {
    Image<std::int32_t> labels(map_.width(), map_.height(), kNone);
    std::int32_t next = 0;
    for (std::size_t i = 0; i < map_.size(); ++i) {
      if (!valid(i)) continue;
      const auto root = static_cast<std::size_t>(sets_.root(i));
      labels[i] = root == i ? next++ : labels[root];
    }
    return labels;
  }

  const SurfaceMap& map_;
  const PixelFeatures& features_;
  const Image<float>& edges_;
  const Image<std::int32_t>& clusters_;
  const SuperPixelOptions& options_;
  const float strong_;
  PixelSets sets_;
  std::vector<std::uint8_t> labelled_;
};

}  // namespace

Image<std::int32_t> connect(const SurfaceMap& map, const PixelFeatures& features,
                            const Image<float>& edges, const Image<std::int32_t>& clusters,
                            const SuperPixelOptions& options) {
  return Connector(map, features, edges, clusters, options).run();
}

}  // namespace bpa::detail
