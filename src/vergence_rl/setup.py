from setuptools import find_packages, setup

package = "vergence_rl"

setup(
    name=package,
    version="0.1.0",
    description="Learns to move the eye muscles by CACLA+VAR or by hindsight regression.",
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
            "vergence_rl_node = vergence_rl.node:main",
        ]
    },
)
