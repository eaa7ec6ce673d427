// SPDX-License-Identifier: GPL-3.0-or-later
// Embree and oneTBB, as this process really has them.
#pragma once

#include <string>

namespace sfumato {

// What is wrong with them, or nothing. A process may hold another Embree or oneTBB than the one that this was compiled
// for, and where their functions are found first, structures mean something else: all solids turn black.
std::string library_problem();

// Ends oneTBB's threads, before what they need goes with the process. They start again when there is work. False where
// something that works on them is still there; then they go on.
bool end_threads();

} // namespace sfumato
