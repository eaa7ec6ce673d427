// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/events.hpp"

#include <algorithm>

namespace sfumato {
namespace {

Fragment together(const Fragment &near, const Fragment &far) {
    return {near.distance, near.radiance + near.left * far.radiance, near.left * far.left};
}

// Of the farther half every two neighbours become one: most of them are hidden by the nearer half.
void thin(std::vector<Fragment> &fragments) {
    sort_fragments(fragments);
    if (fragments.size() < Events::MOST / 2) {
        return;
    }
    std::size_t to = fragments.size() / 2;
    for (std::size_t from = to; from < fragments.size(); from += 2) {
        const bool last = from + 1 == fragments.size();
        fragments[to++] = last ? fragments[from] : together(fragments[from], fragments[from + 1]);
    }
    fragments.resize(to);
}

} // namespace

void sort_fragments(std::vector<Fragment> &fragments) {
    std::sort(fragments.begin(), fragments.end(),
              [](const Fragment &a, const Fragment &b) { return a.distance < b.distance; });
    glm::vec3 left(1.0F);
    for (std::size_t i = 0; i < fragments.size(); ++i) {
        left *= fragments[i].left;
        if (std::max({left.x, left.y, left.z}) < OPAQUE_LEFT) {
            fragments.resize(i + 1);
            return;
        }
    }
}

void Events::add(std::size_t lane, const Fragment &fragment) {
    std::vector<Fragment> &list = fragments[lane];
    if (list.size() >= MOST) {
        thin(list);
    }
    list.push_back(fragment);
}

bool Events::any() const {
    return slices.count > 0 ||
           std::any_of(fragments.begin(), fragments.end(), [](const auto &l) { return !l.empty(); });
}

void Events::clear() {
    for (std::vector<Fragment> &list : fragments) {
        list.clear();
    }
    slices.count = 0;
    knots.count = 0;
    knots.values.clear();
    air.count = 0;
    air.values.clear();
}

} // namespace sfumato
