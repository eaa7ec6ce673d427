// SPDX-License-Identifier: GPL-3.0-or-later
// What lets light straight through, a sheet, apart from what is opaque.
#pragma once

#include "scene/kept.hpp"
#include "scene/scene.hpp"

#include <memory>
#include <span>
#include <vector>

namespace sfumato {

// Meshes, each of which is opaque in every triangle or in none.
class Divided {
public:
    // Of a mesh that is both, two take its place: their shapes are kept.
    Divided(std::span<const Instances> meshes, Kept<Shape> &shapes);
    // Meshes of which every hit is asked for, whatever their materials.
    static Divided sheets(std::span<const Instances> meshes);

    [[nodiscard]] std::span<const Instances> meshes() const { return meshes_; }
    [[nodiscard]] bool sheet(std::size_t mesh) const { return !sheet_.empty() && sheet_[mesh]; }

private:
    Divided() = default;

    std::span<const Instances> meshes_; // the scene's own, where none has to be divided
    std::vector<Instances> own_;
    std::vector<bool> sheet_; // of each; or none, where all are opaque
};

} // namespace sfumato
