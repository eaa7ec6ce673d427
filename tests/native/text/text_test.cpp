// SPDX-License-Identifier: GPL-3.0-or-later
// The text of the shaders as C++: all of it compiles for every number that it is used with, and means the same.
#define SFUMATO_ISA text_test
#include "text/air_text.hpp"
#include "text/camera_text.hpp"
#include "text/integrals_text.hpp"
#include "text/lanes.hpp"
#include "text/lights_text.hpp"
#include "text/media_text.hpp"
#include "text/microfacets_text.hpp"
#include "text/rays_text.hpp"
#include "text/strands_text.hpp"
#include "text/surfaces_text.hpp"
#include "text/textures_text.hpp"

#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#define SFUMATO_ALL_MEMBERS(REAL, ISA)                                                                                 \
    template struct AirText<REAL, ISA>;                                                                                \
    template struct CameraText<REAL, ISA>;                                                                             \
    template struct IntegralsText<REAL, ISA>;                                                                          \
    template struct LightsText<REAL, ISA>;                                                                             \
    template struct MediaText<REAL, ISA>;                                                                              \
    template struct MicrofacetsText<REAL, ISA>;                                                                        \
    template struct RaysText<REAL, ISA>;                                                                               \
    template struct StrandsText<REAL, ISA>;                                                                            \
    template struct SurfacesText<REAL, ISA>;                                                                           \
    template struct TexturesText<REAL, ISA>;

namespace sfumato::text {
SFUMATO_ALL_MEMBERS(float, OneLane)
SFUMATO_ALL_MEMBERS(double, OneLane)
SFUMATO_ALL_MEMBERS(text_test::Real, text_test::Isa)
} // namespace sfumato::text

namespace sfumato {
namespace {

constexpr int ANSWERS = 17, LANES = text_test::Isa::LANES;

template <class Real, class Isa>
Real strand_sent(const std::array<Real, 6> &n) {
    text::StrandsText<Real, Isa> strands;
    typename text::StrandsText<Real, Isa>::Fibre fibre;
    fibre.absorption = {n[0], n[1], n[2]};
    fibre.primary = fibre.variance = strands.fibre_variance(n[3] * 0.5F + 0.1F);
    fibre.scale = strands.fibre_scale(n[4] * 0.5F + 0.2F);
    fibre.tilt = n[5] * 0.2F;
    fibre.index = Real(1.55F);
    const auto look = strands.strand_look(fibre, n[0] - 0.5F, n[1] - 1.0F, n[2]);
    return strands.strand_sent(fibre, look, n[3] - 0.5F, n[4] * 3.0F).y + strands.matt_strand(look, n[5], n[1]);
}

// What a stretch before a lamp sends, by one point, and by how much air.
template <class Real, class Isa>
Real lamp_sent(const std::array<Real, 6> &n) {
    text::AirText<Real, Isa> air;
    const Real g = n[0] - 0.5F, from = n[1] - 0.6F, squeeze = air.squeeze_of(g);
    const Real to = from + n[2];
    const auto stretch = air.lit_stretch(n[3], from, to, squeeze);
    const auto point = air.lit_point(stretch, n[4]);
    const Real until = air.lit_until(n[3], from, n[5], squeeze);
    return point.weight * air.cornette_shanks(point.half_sine2, point.half_cosine2, g) + point.place * 0.1F +
           point.radius * 0.1F + until * 0.01F;
}

// One answer from every room; the numbers are in [0, 1].
template <class Real, class Isa>
std::array<Real, ANSWERS> answers(const std::array<Real, 6> &n) {
    using Vec3 = glm::vec<3, Real>;
    const Vec3 zenith(Real(0.0F), Real(0.0F), Real(1.0F)), view(n[0], n[1] - 0.5F, n[2] + 0.5F);
    const Vec3 middle(n[3] - 0.5F, n[4], n[5] + 1.0F), x(Real(0.4F), n[0] * 0.1F, Real(0.0F));
    const Vec3 y(Real(0.0F), Real(0.3F), n[1] * 0.2F);
    text::RaysText<Real, Isa> rays;
    text::CameraText<Real, Isa> camera;
    text::IntegralsText<Real, Isa> integrals;
    text::MicrofacetsText<Real, Isa> facets;
    text::AirText<Real, Isa> air;
    const auto gloss =
        facets.microfacet_quad(facets.microfacets(BRDF_GGX, view, n[1] * 0.5F + 0.2F, n[2] * 0.5F + 0.2F),
                               middle - x - y, middle - x + y, middle + x + y, middle + x - y);
    return {rays.harmonic(3.0F, n[0]).sine,
            rays.slice_share(2.0F, 8.0F, n[0] * 0.5F, n[0] * 0.5F + 0.2F),
            camera.clip_to_box({Real(0.0F), Real(9.0F)}, Vec3(-n[0], -n[1], -n[2]), view, zenith + view).near_t,
            text::LightsText<Real, Isa>().octahedral(view).y,
            text::MediaText<Real, Isa>().henyey_greenstein(n[4], n[5] * 0.8F),
            text::SurfacesText<Real, Isa>().diffuse_rim(n[0], n[1], n[2], n[3]),
            text::SurfacesText<Real, Isa>().grooves(n[0], n[1], n[2], n[3]),
            text::SurfacesText<Real, Isa>().grooves_albedo(n[0], n[3]) *
                text::SurfacesText<Real, Isa>().grooves_again(n[1], n[3]),
            text::SurfacesText<Real, Isa>().sheen(n[2]) +
                0.1F * text::SurfacesText<Real, Isa>().fibres(n[0], n[1], n[2] * 0.5F, n[3]),
            0.01F * text::SurfacesText<Real, Isa>().velvet(n[0], n[1], n[2] * 0.5F, n[3] + 0.5F),
            integrals.diffuse_quad(zenith, middle - x - y, middle - x + y, middle + x + y, middle + x - y),
            integrals.diffuse_ellipse(zenith, middle, x, y),
            gloss.plain,
            gloss.fresnel,
            strand_sent<Real, Isa>(n),
            lamp_sent<Real, Isa>(n),
            air.lit_by_sun(air.air_column(n[0], n[1] - 0.5F, n[2]), n[3], n[4]) + air.rayleigh(n[5])};
}

TEST(Text, MeansTheSameForEveryNumber) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<float> uniform(0.05F, 1.0F);
    for (int round = 0; round < 50; ++round) {
        alignas(64) float numbers[6][LANES];
        std::array<text_test::Real, 6> of_lanes;
        for (int i = 0; i < 6; ++i) {
            for (float &number : numbers[i]) {
                number = uniform(generator);
            }
            of_lanes[static_cast<std::size_t>(i)] = text_test::Isa::load(numbers[i]);
        }
        const auto lanes = answers<text_test::Real, text_test::Isa>(of_lanes);
        for (int lane = 0; lane < LANES; ++lane) {
            std::array<float, 6> single{};
            std::array<double, 6> twice{};
            for (std::size_t i = 0; i < 6; ++i) {
                twice[i] = double{single[i] = numbers[i][lane]};
            }
            const auto singles = answers<float, text::OneLane>(single);
            const auto doubles = answers<double, text::OneLane>(twice);
            for (std::size_t k = 0; k < ANSWERS; ++k) {
                alignas(64) float of_lane[LANES];
                text_test::Isa::store(lanes[k], of_lane);
                const double near = 2e-5 * (1.0 + std::abs(doubles[k]));
                EXPECT_NEAR(doubles[k], double{singles[k]}, near) << "answer " << k;
                EXPECT_NEAR(doubles[k], double{of_lane[lane]}, near) << "answer " << k << ", lane " << lane;
            }
        }
    }
}

} // namespace
} // namespace sfumato
