from setuptools import find_packages, setup

package = "sparse_coder"

setup(
    name=package,
    version="0.1.0",
    description="Learns binocular basis functions; publishes features and reward.",
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
            "sparse_coder_node = sparse_coder.node:main",
        ]
    },
)
