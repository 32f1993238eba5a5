from glob import glob

from setuptools import find_packages, setup

package = "experiment_manager"

setup(
    name=package,
    version="0.1.0",
    description="Drives episodes and tests of active binocular vision and records them.",
    maintainer="Active binocular vision maintainers",
    maintainer_email="maintainers@active-binocular-vision.example",
    license="Apache-2.0",
    url="https://active-binocular-vision.example",
    packages=find_packages(include=[package, f"{package}.*"]),
    package_data={
        package: [
            "profiles/*.yaml",
            "profiles/*/*.yaml",
            "live/layout.json",
            "live/page.html",
            "trained/eyes/*",
        ]
    },
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml", "LICENSE", "README.md"]),
        (f"share/{package}/launch", glob("launch/*.launch.py")),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "experiment_manager_node = experiment_manager.node.manager_node:main",
            "experiment_manager_live_view = experiment_manager.live.node:main",
        ]
    },
)
