// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes of any size are met alike.
#include "support/pictures.hpp"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

// A square of 2 n^2 triangles, tilted over the floor.
Mesh square(unsigned n) {
    Mesh mesh;
    for (unsigned j = 0; j <= n; ++j) {
        for (unsigned i = 0; i <= n; ++i) {
            const float u = float(i) / float(n), v = float(j) / float(n);
            mesh.vertices.emplace_back(2.0F * u - 1.0F, 2.0F * v - 1.0F, 0.4F + 0.3F * u);
            if (i < n && j < n) {
                const unsigned a = j * (n + 1) + i;
                mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, a + n + 2}, {a, a + n + 2, a + n + 1}});
            }
        }
    }
    mesh.albedo = {glm::vec3(0.8F, 0.5F, 0.2F)};
    return mesh;
}

// Of so many triangles a tree of another kind is made.
TEST(Surfaces, OfMillionsOfTrianglesLookAsOfTwo) {
    std::vector<std::vector<float>> pictures;
    for (const unsigned n : {1U, 1030U}) {
        Scene scene = smoke_over_floor();
        scene.meshes.emplace_back(square(n));
        pictures.push_back(Frame(scene, {}).render(camera, WIDTH, HEIGHT, 1, {}).value());
    }
    for (std::size_t i = 0; i < pictures[0].size(); ++i) {
        EXPECT_NEAR(pictures[0][i], pictures[1][i], 1e-4) << "pixel " << i / 4;
    }
}

} // namespace
} // namespace sfumato
