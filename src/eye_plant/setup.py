from glob import glob

from setuptools import find_packages, setup

package = "eye_plant"

setup(
    name=package,
    version="0.1.0",
    description="Two eyes with twelve muscles in MuJoCo, what they see and what they cost.",
    maintainer="Active binocular vision maintainers",
    maintainer_email="maintainers@active-binocular-vision.example",
    license="Apache-2.0",
    url="https://active-binocular-vision.example",
    packages=find_packages(include=[package, f"{package}.*"]),
    package_data={package: ["export/README.md"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml", "LICENSE", "README.md"]),
        (f"share/{package}/launch", glob("launch/*.launch.py")),
    ],
    install_requires=["setuptools", "mujoco>=4"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "eye_plant_node = eye_plant.node.plant_node:main",
        ]
    },
)
