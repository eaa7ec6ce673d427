# SPDX-License-Identifier: GPL-3.0-or-later
# The modules of a release, one for each Python that Blender has. They share nothing with the process that loads them:
# Embree, oneTBB, OpenImageIO and libstdc++ are inside, and no name but PyInit_sfumato can be seen. Else every rtc* call would be bound
# to the Embree of Blender's executable, which may be another one.
set(headers ${SFUMATO_THIRD_PARTY}/headers/usr/include)
set(python_3.10 ${SFUMATO_THIRD_PARTY}/python3.10/include/python3.10)
set(python_3.11 /usr/include/python3.11)
set(python_3.13 ${headers} ${headers}/python3.13)

add_library(older_glibc OBJECT packaging/older_glibc.cpp)
target_compile_options(older_glibc PRIVATE ${warnings})
# Each of the functions there takes the place of the one that it is named after, in the libraries inside, too.
file(READ packaging/older_glibc.cpp older_glibc)
string(REGEX MATCHALL "\n(REPLACED\\(|extern \"C\" int __wrap_)[a-z0-9_]+" replaced "${older_glibc}")
list(TRANSFORM replaced REPLACE ".*(REPLACED.|__wrap_)" "LINKER:--wrap=")

foreach(version 3.10 3.11 3.13)
  string(REPLACE . "" number ${version})
  set(module sfumato_${number})
  add_library(${module} MODULE ${module_sources} $<TARGET_OBJECTS:older_glibc>)
  target_include_directories(${module} SYSTEM PRIVATE ${python_${version}} ${headers})
  # Else pybind11 would share its types with every module of a process that was made with a similar one.
  target_compile_definitions(${module} PRIVATE PYBIND11_INTERNALS_KIND="_sfumato")
  target_link_options(${module} PRIVATE -static-libstdc++ ${replaced} LINKER:-s,--gc-sections,--exclude-libs,ALL
    LINKER:--version-script=${CMAKE_SOURCE_DIR}/packaging/exports.map LINKER:-z,now,-z,nodynamic-undefined-weak,--build-id=none
    # What glibc 2.34 took into itself is elsewhere in older ones.
    LINKER:--no-as-needed -l:libpthread.so.0 LINKER:--as-needed)
  set_target_properties(${module} PROPERTIES PREFIX "" OUTPUT_NAME sfumato SUFFIX .cpython-${number}-x86_64-linux-gnu.so
    LINK_DEPENDS "${CMAKE_SOURCE_DIR}/packaging/exports.map")
  list(APPEND modules ${module})
endforeach()
