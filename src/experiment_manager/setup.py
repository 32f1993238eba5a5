from glob import glob

from setuptools import find_packages, setup

package = "experiment_manager"

setup(
    name=package,
    version="0.1.0",
    description="Trains and tests active binocular vision, records it, and draws its figures.",
    maintainer="Active binocular vision maintainers",
    maintainer_email="maintainers@active-binocular-vision.example",
    license="Apache-2.0",
    url="https://active-binocular-vision.example",
    packages=find_packages(include=[package, f"{package}.*"]),
    package_data={package: ["profiles/*.yaml", "profiles/*/*.yaml", "live/layout.json"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml", "LICENSE", "README.md"]),
        (f"share/{package}/config", glob("config/*.yaml")),
        (f"share/{package}/launch", glob("launch/*.launch.py")),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "node = experiment_manager.node.manager_node:main",
            "live_view = experiment_manager.live.node:main",
            "run_experiment = experiment_manager.commands.run_experiment:main",
            "sweep = experiment_manager.commands.sweep:main",
            "evaluate = experiment_manager.commands.evaluate:main",
            "report = experiment_manager.commands.report:main",
            "list_parameters = experiment_manager.commands.list_parameters:main",
            "inspect_bag = experiment_manager.commands.inspect_bag:main",
        ]
    },
)
