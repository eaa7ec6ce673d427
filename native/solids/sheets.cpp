// SPDX-License-Identifier: GPL-3.0-or-later
#include "solids/sheets.hpp"

#include "textures/pattern.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace sfumato {
namespace {

// Of each row of materials, whether it lets light through.
std::vector<bool> clear_rows(const Materials &materials) {
    std::vector<bool> clear;
    for (const glm::vec3 &left : materials.transmittance) {
        clear.push_back(std::max({left.x, left.y, left.z}) > 0.0F);
    }
    clear.resize(std::max(clear.size(), materials.patterns.size()));
    for (std::size_t row = 0; row < materials.patterns.size(); ++row) {
        clear[row] = clear[row] || (materials.patterns[row] && materials.patterns[row]->dims);
    }
    return clear;
}

bool is_clear(const Shape &shape, const std::vector<bool> &clear, std::size_t triangle) {
    const std::size_t row = shape.material.empty() ? 0 : shape.material[triangle];
    return row < clear.size() && clear[row];
}

// Those of its triangles that let light through, or the others.
Shape part_of(const Shape &shape, const std::vector<bool> &clear, bool wanted) {
    Shape part;
    part.vertices = shape.vertices;
    part.vertex_normals = shape.vertex_normals;
    part.moving = shape.moving;
    const auto chosen = [&](const auto &from, auto &to) {
        for (std::size_t i = 0; i < from.size(); ++i) {
            if (is_clear(shape, clear, i) == wanted) {
                to.push_back(from[i]);
            }
        }
    };
    chosen(shape.triangles, part.triangles);
    chosen(shape.corner_normals, part.corner_normals);
    chosen(shape.material, part.material);
    chosen(shape.corner_tangents, part.corner_tangents);
    part.channel_count = shape.channel_count;
    const std::size_t each = std::size_t{3} * shape.channel_count;
    for (std::size_t i = 0; i < shape.channels.size() / std::max(each, std::size_t{1}); ++i) {
        if (is_clear(shape, clear, i) == wanted) {
            const auto first = shape.channels.begin() + static_cast<std::ptrdiff_t>(i * each);
            part.channels.insert(part.channels.end(), first, first + static_cast<std::ptrdiff_t>(each));
        }
    }
    return part;
}

} // namespace

Divided::Divided(std::span<const Instances> meshes, Kept<Shape> &shapes) : meshes_(meshes) {
    const auto lets_light_through = [](const Instances &mesh) {
        const std::vector<bool> clear = clear_rows(mesh.materials);
        return std::find(clear.begin(), clear.end(), true) != clear.end();
    };
    if (std::none_of(meshes.begin(), meshes.end(), lets_light_through)) {
        return;
    }
    for (const Instances &mesh : meshes) {
        const std::vector<bool> clear = clear_rows(mesh.materials);
        const std::size_t triangles = mesh.shape ? mesh.shape->triangles.size() : 0;
        std::size_t count = 0;
        for (std::size_t i = 0; i < triangles; ++i) {
            count += is_clear(*mesh.shape, clear, i) ? 1U : 0U;
        }
        if (count == 0 || count == triangles) {
            own_.push_back(mesh);
            sheet_.push_back(count > 0);
            continue;
        }
        for (const bool wanted : {false, true}) {
            Key key;
            key.part(mesh.shape).number(wanted);
            for (const bool row : clear) {
                key.number(row);
            }
            Instances &part = own_.emplace_back(mesh);
            part.shape = shapes.get(key, [&] { return part_of(*mesh.shape, clear, wanted); });
            sheet_.push_back(wanted);
        }
    }
    meshes_ = own_;
}

Divided Divided::sheets(std::span<const Instances> meshes) {
    Divided out;
    out.meshes_ = meshes;
    out.sheet_.assign(meshes.size(), true);
    return out;
}

} // namespace sfumato
