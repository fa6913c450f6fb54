"""Conan 2 recipe of the sources that it lies in: conan create packaging/conan

Written for Conan's documented interface and never run against a remote (docs/notes/platforms.md).
"""

import os

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy


class WelkinConan(ConanFile):
    name = "welkin"
    version = "0.2.0"
    license = "MIT"
    description = "Environments to light, on the CPU"
    topics = ("graphics", "image-based-lighting", "spherical-harmonics", "sky")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {
        "shared": [True, False],
        "fPIC": [True, False],
        "with_files": [True, False],
        "with_command": [True, False],
    }
    default_options = {"shared": False, "fPIC": True, "with_files": True, "with_command": False}

    def export_sources(self):
        root = os.path.join(self.recipe_folder, "..", "..")
        for pattern in ("CMakeLists.txt", "third_party.cmake", "LICENSE", "cmake/*", "include/*", "module/*", "tools/*",
                        "tests/reference/*", "perf/report/*"):
            copy(self, pattern, src=root, dst=self.export_sources_folder)

    def config_options(self):
        if self.settings.os == "Windows":
            self.options.rm_safe("fPIC")

    def configure(self):
        if self.options.shared:
            self.options.rm_safe("fPIC")

    def layout(self):
        cmake_layout(self)

    def validate(self):
        check_min_cppstd(self, 20)

    def requirements(self):
        # Public headers name GLM's vectors; the rest stays inside.
        self.requires("glm/[>=0.9.9.8]", transitive_headers=True)
        self.requires("onetbb/[>=2021.8]")
        if self.settings.arch == "x86_64":  # for ARM we have registers of our own
            self.requires("xsimd/[>=8.1 <9]")
        if self.options.with_files:
            self.requires("libjpeg-turbo/[>=2.1]")
            self.requires("libspng/[>=0.7]")
            self.requires("libwebp/[>=1.2]")
            self.requires("nlohmann_json/[>=3.11]")
            self.requires("openexr/[>=3.1 <4]")
            self.requires("xxhash/[>=0.8]")
            self.requires("zlib/[>=1.2.11 <2]")
            self.requires("zstd/[>=1.5]")
        if self.options.with_command:
            self.requires("cli11/[>=2.3]")

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["WELKIN_FILES"] = bool(self.options.with_files)
        toolchain.cache_variables["WELKIN_TOOLS"] = bool(self.options.with_command)
        toolchain.cache_variables["WELKIN_ASTC"] = False  # takes astcenc as a library, of which we know no package
        for part in ("TESTS", "PERF", "EXAMPLES"):
            toolchain.cache_variables[f"WELKIN_{part}"] = False
        toolchain.generate()
        dependencies = CMakeDeps(self)
        # Under the names that third_party.cmake looks for.
        for package, name, target in (
            ("libspng", "SPNG", "SPNG::SPNG"),
            ("libwebp", "WebP", "WebP::WebP"),
            ("xxhash", "XXHASH", "XXHASH::XXHASH"),
            ("zstd", "ZSTD", "ZSTD::ZSTD"),
        ):
            dependencies.set_property(package, "cmake_file_name", name)
            dependencies.set_property(package, "cmake_target_name", target)
            dependencies.set_property(package, "cmake_find_mode", "both")
        dependencies.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", src=self.source_folder, dst=os.path.join(self.package_folder, "licenses"))
        CMake(self).install()

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "welkin")
        self.cpp_info.set_property("cmake_target_name", "welkin::welkin")
        core = self.cpp_info.components["core"]
        core.libs = ["welkin-core"]
        core.set_property("cmake_target_name", "welkin::core")
        core.set_property("pkg_config_name", "welkin-core")
        core.requires = ["glm::glm", "onetbb::onetbb"]
        if self.settings.arch == "x86_64":
            core.requires.append("xsimd::xsimd")
        if self.settings.os == "Linux":
            core.system_libs = ["m", "pthread"]
        if not self.options.with_files:
            return
        files = self.cpp_info.components["files"]
        files.libs = ["welkin"] if self.options.shared else ["welkin-files"]
        files.set_property("cmake_target_name", "welkin::files")
        files.set_property("pkg_config_name", "welkin")
        files.requires = ["core", "libjpeg-turbo::libjpeg-turbo", "libspng::libspng", "libwebp::libwebp", "nlohmann_json::nlohmann_json",
                          "openexr::openexr", "xxhash::xxhash", "zlib::zlib", "zstd::zstd"]
