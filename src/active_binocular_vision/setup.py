from setuptools import find_packages, setup

package = "active_binocular_vision"

setup(
    name=package,
    version="0.1.0",
    description="What people import and command: runs, learners, examinations, figures, pages.",
    maintainer="Active binocular vision maintainers",
    maintainer_email="maintainers@active-binocular-vision.example",
    license="Apache-2.0",
    url="https://active-binocular-vision.example",
    packages=find_packages(include=[package, f"{package}.*"]),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml", "LICENSE", "README.md"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "abv = active_binocular_vision.command_lines.abv:main",
        ]
    },
)
