// Nine spheres lit by probe.ktx alone, as an application of Qt Quick 3D has them: roughness 0.2, 0.5 and 0.8 from left to
// right, metalness 1, 0.5 and 0 from top to bottom. Writes what it sees to spheres.png, in linear light, and ends.
import QtQuick
import QtQuick3D

Window {
    id: window
    width: 192
    height: 192
    visible: true
    color: "black"

    View3D {
        id: view
        anchors.fill: parent
        environment: SceneEnvironment {
            backgroundMode: SceneEnvironment.Color
            clearColor: "black"
            antialiasingMode: SceneEnvironment.NoAA
            tonemapMode: SceneEnvironment.TonemapModeNone
            probeExposure: 0.5
            lightProbe: Texture { source: "probe.ktx" }
        }
        OrthographicCamera { position: Qt.vector3d(0, 0, 600) }
        Repeater3D {
            model: 9
            Model {
                required property int index
                source: "#Sphere" // of radius 50
                scale: Qt.vector3d(0.6, 0.6, 0.6)
                position: Qt.vector3d(64 * (index % 3 - 1), 64 * (1 - Math.floor(index / 3)), 0)
                materials: PrincipledMaterial {
                    baseColor: "white"
                    roughness: [0.2, 0.5, 0.8][index % 3]
                    metalness: [1, 0.5, 0][Math.floor(index / 3)]
                }
            }
        }
    }
    property int frames: 0
    onFrameSwapped: {
        if (++frames === 5)
            view.grabToImage(result => Qt.exit(result.saveToFile("spheres.png") ? 0 : 1));
        window.update();
    }
}
